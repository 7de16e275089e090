#include "server/protocol/frame_message.h"

#include <algorithm>

#include "core/base/json_reader.h"

namespace rimlight::server {
namespace {

using nlohmann::json;

constexpr std::size_t kLengthBytes = 4;
constexpr std::size_t kLargestHeader = 16 * 1024;
constexpr int kLargestSide = 16384;
constexpr double kLargestMs = 1e12;

const std::vector<std::string> kCodecNames{"jpeg", "png"};

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

std::string header_text(const FrameHeader& header) {
  const json text{{"frame", header.frame},
                  {"epoch", header.revision.epoch},
                  {"revision", header.revision.number},
                  {"codec", kCodecNames[header.codec == Codec::jpeg ? 0 : 1]},
                  {"width", header.width},
                  {"height", header.height},
                  {"exact", header.exact},
                  {"terms", header.terms},
                  {"residual", header.residual},
                  {"estimate", header.estimate ? json(*header.estimate) : json()},
                  {"unshown", unshown_of(header)},
                  {"times",
                   {{"queue_ms", rounded_ms(header.queue_ms)},
                    {"rotate_ms", rounded_ms(header.rotate_ms)},
                    {"update_ms", rounded_ms(header.update_ms)},
                    {"display_ms", rounded_ms(header.display_ms)},
                    {"encode_ms", rounded_ms(header.encode_ms)}}}};
  // Names of materials may hold bytes that are not UTF-8: replaced, not refused.
  return text.dump(-1, ' ', false, json::error_handler_t::replace);
}

FrameHeader read_header(const JsonReader& reader) {
  reader.allow_only({"frame", "epoch", "revision", "codec", "width", "height", "exact", "terms",
                     "residual", "estimate", "unshown", "times"});
  FrameHeader header;
  header.frame = reader.member("frame").integer(0, kLargestWhole);
  header.revision = {reader.member("epoch").integer(0, kLargestWhole),
                     reader.member("revision").integer(0, kLargestWhole)};
  header.codec = reader.member("codec").one_of(kCodecNames) == 0 ? Codec::jpeg : Codec::png;
  header.width = static_cast<int>(reader.member("width").integer(1, kLargestSide));
  header.height = static_cast<int>(reader.member("height").integer(1, kLargestSide));
  header.exact = reader.member("exact").boolean();
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
  return header;
}

}  // namespace

FramePtr write_frame_message(const FrameHeader& header, std::span<const std::uint8_t> payload) {
  const std::string text = header_text(header);
  auto message = std::make_shared<FrameMessage>();
  message->frame = header.frame;
  message->bytes.resize(kLengthBytes + text.size() + payload.size());
  auto out = message->bytes.begin();
  for (std::size_t i = 0; i < kLengthBytes; ++i) {
    *out++ = static_cast<std::uint8_t>(text.size() >> (8 * i));
  }
  out = std::copy(text.begin(), text.end(), out);
  std::copy(payload.begin(), payload.end(), out);
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
  return {read_header(JsonReader(document, source)), message.subspan(kLengthBytes + length)};
}

}  // namespace rimlight::server
