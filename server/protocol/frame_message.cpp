#include "server/protocol/frame_message.h"

#include <algorithm>
#include <utility>

#include "core/base/check.h"
#include "core/base/json_reader.h"

namespace rimlight::server {
namespace {

using nlohmann::json;

constexpr std::size_t kLengthBytes = 4;
constexpr std::size_t kLargestHeader = 16 * 1024;
constexpr int kLargestSide = 16384;
constexpr double kLargestMs = 1e12;
constexpr int kMostRungs = 64;
/// No image of the largest size is larger.
constexpr std::int64_t kLargestPayload = std::int64_t{1} << 32;

/// In the order of Codec.
const std::vector<std::string> kCodecNames{"jpeg", "png", "vp8"};

/// Microseconds are finer than any clock here: three decimals keep headers short.
double rounded_ms(double ms) {
  return static_cast<double>(static_cast<std::int64_t>(ms * 1e3 + 0.5)) / 1e3;
}

json unshown_of(const FrameHeader& header) {
  json list = json::array();
  for (const std::string& words : header.unshown) {
    if (list.size() + 1 == kMostUnshown && header.unshown.size() > kMostUnshown) {
      list.push_back(std::to_string(header.unshown.size() - list.size()) + " things more");
      break;
    }
    list.push_back(words.substr(0, kLongestUnshown));
  }
  return list;
}

json part_of(const FrameHeader& header) {
  if (!header.part) return {};
  return {{"offset", header.part->offset}, {"size", header.part->size}};
}

std::string header_text(const FrameHeader& header) {
  const json text{{"frame", header.frame},
                  {"epoch", header.revision.epoch},
                  {"revision", header.revision.number},
                  {"codec", kCodecNames[static_cast<std::size_t>(header.codec)]},
                  {"width", header.width},
                  {"height", header.height},
                  {"exact", header.exact},
                  {"key", header.key},
                  {"rung", header.rung ? json(*header.rung) : json()},
                  {"quality", header.quality ? json(*header.quality) : json()},
                  {"part", part_of(header)},
                  {"terms", header.terms},
                  {"residual", header.residual},
                  {"estimate", header.estimate ? json(*header.estimate) : json()},
                  {"unshown", unshown_of(header)},
                  {"times",
                   {{"queue_ms", rounded_ms(header.queue_ms)},
                    {"rotate_ms", rounded_ms(header.rotate_ms)},
                    {"update_ms", rounded_ms(header.update_ms)},
                    {"display_ms", rounded_ms(header.display_ms)},
                    {"encode_ms", rounded_ms(header.encode_ms)},
                    {"wait_ms", rounded_ms(header.wait_ms)}}}};
  // Names of materials may hold bytes that are not UTF-8: replaced, not refused.
  return text.dump(-1, ' ', false, json::error_handler_t::replace);
}

void read_encoding(const JsonReader& reader, FrameHeader& header) {
  header.key = reader.member("key").boolean();
  if (const auto rung = reader.member("rung"); !rung.value().is_null()) {
    header.rung = static_cast<int>(rung.integer(0, kMostRungs - 1));
  }
  if (const auto quality = reader.member("quality"); !quality.value().is_null()) {
    header.quality = static_cast<int>(quality.integer(0, 100));
  }
  if (const auto part = reader.member("part"); !part.value().is_null()) {
    part.allow_only({"offset", "size"});
    const std::int64_t size = part.member("size").integer(1, kLargestPayload);
    const std::int64_t offset = part.member("offset").integer(0, size - 1);
    header.part = {static_cast<std::size_t>(offset), static_cast<std::size_t>(size)};
  }
}

FrameHeader read_header(const JsonReader& reader) {
  reader.allow_only({"frame", "epoch", "revision", "codec", "width", "height", "exact", "key",
                     "rung", "quality", "part", "terms", "residual", "estimate", "unshown",
                     "times"});
  FrameHeader header;
  header.frame = reader.member("frame").integer(0, kLargestWhole);
  header.revision = {reader.member("epoch").integer(0, kLargestWhole),
                     reader.member("revision").integer(0, kLargestWhole)};
  header.codec = static_cast<Codec>(reader.member("codec").one_of(kCodecNames));
  header.width = static_cast<int>(reader.member("width").integer(1, kLargestSide));
  header.height = static_cast<int>(reader.member("height").integer(1, kLargestSide));
  header.exact = reader.member("exact").boolean();
  read_encoding(reader, header);
  header.terms = reader.member("terms").integer(0, kLargestWhole);
  header.residual = reader.member("residual").number(0);
  if (const auto estimate = reader.member("estimate"); !estimate.value().is_null()) {
    header.estimate = estimate.number(0);
  }
  for (const JsonReader& words : reader.member("unshown").elements(0, kMostUnshown)) {
    header.unshown.push_back(words.string());
  }
  const JsonReader times = reader.member("times");
  header.queue_ms = times.member("queue_ms").number(0, kLargestMs);
  header.rotate_ms = times.member("rotate_ms").number(0, kLargestMs);
  header.update_ms = times.member("update_ms").number(0, kLargestMs);
  header.display_ms = times.member("display_ms").number(0, kLargestMs);
  header.encode_ms = times.member("encode_ms").number(0, kLargestMs);
  header.wait_ms = times.member("wait_ms").number(0, kLargestMs);
  return header;
}

}  // namespace

std::vector<std::uint8_t> FrameMessage::bytes() const {
  std::vector<std::uint8_t> whole = head;
  const auto rest = body();
  whole.insert(whole.end(), rest.begin(), rest.end());
  return whole;
}

FramePtr write_frame_message(const FrameHeader& header, Payload payload) {
  const std::size_t bytes = payload->size();
  return write_frame_message(header, std::move(payload), bytes);
}

FramePtr write_frame_message(const FrameHeader& header, Payload payload, std::size_t bytes) {
  const std::string text = header_text(header);
  auto message = std::make_shared<FrameMessage>();
  message->frame = header.frame;
  message->first = header.part ? header.part->offset : 0;
  message->count = bytes;
  RIMLIGHT_CHECK(message->first <= payload->size() && bytes <= payload->size() - message->first);
  message->payload = std::move(payload);
  message->head.resize(kLengthBytes + text.size());
  auto out = message->head.begin();
  for (std::size_t i = 0; i < kLengthBytes; ++i) {
    *out++ = static_cast<std::uint8_t>(text.size() >> (8 * i));
  }
  std::copy(text.begin(), text.end(), out);
  return message;
}

ParsedFrame parse_frame_message(std::span<const std::uint8_t> message, const std::string& source) {
  if (message.size() < kLengthBytes) {
    throw Error(source, std::to_string(message.size()) + " bytes", "a u32 header length first");
  }
  std::size_t length = 0;
  for (std::size_t i = 0; i < kLengthBytes; ++i) length |= std::size_t{message[i]} << (8 * i);
  const std::size_t most = std::min(kLargestHeader, message.size() - kLengthBytes);
  if (length > most) {
    throw Error(source, "a header of " + std::to_string(length) + " bytes",
                "at most " + std::to_string(most));
  }
  const auto header = message.subspan(kLengthBytes, length);
  const json document =
      parse_json({reinterpret_cast<const char*>(header.data()), header.size()}, source);
  ParsedFrame frame{read_header(JsonReader(document, source)),
                    message.subspan(kLengthBytes + length)};
  if (const auto& part = frame.header.part;
      part && frame.payload.size() > part->size - part->offset) {
    throw Error(source, std::to_string(frame.payload.size()) + " bytes of a part",
                "at most " + std::to_string(part->size - part->offset));
  }
  return frame;
}

}  // namespace rimlight::server
