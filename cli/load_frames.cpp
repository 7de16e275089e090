#include "cli/load_frames.h"

#include <utility>

#include "core/base/error.h"

namespace rimlight {

std::string display_message(LoadCodec codec) {
  return codec == LoadCodec::vp8
             ? R"({"type":"display","codecs":["vp8","jpeg","png"],"parts":true})"
             : R"({"type":"display","codecs":["jpeg","png"],"parts":true})";
}

std::optional<LoadFrames::Image> LoadFrames::take(std::span<const std::uint8_t> message) {
  const server::ParsedFrame frame = server::parse_frame_message(message, "frame");
  Image image{frame.header, {frame.payload.begin(), frame.payload.end()}, false};
  if (const auto& part = frame.header.part) {
    if (part->offset == 0 || parts_of_ != frame.header.frame) parts_.clear();
    parts_of_ = frame.header.frame;
    if (part->offset != parts_.size()) {
      throw Error("frame", "a part at " + std::to_string(part->offset),
                  "the one at " + std::to_string(parts_.size()));
    }
    parts_.insert(parts_.end(), frame.payload.begin(), frame.payload.end());
    if (parts_.size() < part->size) return std::nullopt;
    image.payload = std::exchange(parts_, {});
  }
  if (const auto rung = frame.header.rung) {
    RungCount& count = rungs_[*rung];
    count.codec = frame.header.codec;
    ++count.frames;
    count.bytes += static_cast<std::int64_t>(message.size());
  }
  image.is_changed = is_changed(image.header, image.payload);
  return image;
}

bool LoadFrames::is_changed(const server::FrameHeader& header,
                            const std::vector<std::uint8_t>& payload) {
  if (header.codec == server::Codec::vp8) {
    if (!decoder_) decoder_ = std::make_unique<Vp8Decoder>();
    decoder_->decode(payload, "frame " + std::to_string(header.frame), picture_);
    const bool is_other = picture_.bytes != last_pixels_;
    last_pixels_ = picture_.bytes;
    return is_other;
  }
  // JPEG and PNG encoders are functions of the pixels: other bytes are other pixels.
  const bool is_other = payload != last_payload_;
  last_payload_ = payload;
  return is_other;
}

}  // namespace rimlight
