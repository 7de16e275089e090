#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/image/vp8_codec.h"
#include "server/protocol/frame_message.h"

namespace rimlight {

/// What a scripted client says that it can show.
enum class LoadCodec { jpeg, vp8 };

/// The `display` message of such a client; it takes lossless frames in parts.
std::string display_message(LoadCodec codec);

/// Frames in motion of one rung, as they came.
struct RungCount {
  server::Codec codec = server::Codec::jpeg;
  std::int64_t frames = 0;
  std::int64_t bytes = 0;
};
using RungCounts = std::map<int, RungCount>;

/// What a client does with frames: puts parts together, and decodes VP8, so that a stream that
/// hangs together wrongly is found. One thread.
class LoadFrames {
 public:
  struct Image {
    server::FrameHeader header;
    std::vector<std::uint8_t> payload;  // whole
    bool is_changed = false;            // other pixels than the image before
  };
  /// Nothing for a part that is not the last. Throws Error: what is no frame, or cannot be decoded.
  std::optional<Image> take(std::span<const std::uint8_t> message);

  const RungCounts& rungs() const { return rungs_; }

 private:
  bool is_changed(const server::FrameHeader& header, const std::vector<std::uint8_t>& payload);

  std::unique_ptr<Vp8Decoder> decoder_;
  Rgb8Image picture_;
  AlignedVector<std::uint8_t> last_pixels_;  // of VP8
  std::vector<std::uint8_t> last_payload_;   // of the others
  std::vector<std::uint8_t> parts_;
  std::int64_t parts_of_ = -1;  // frame
  RungCounts rungs_;
};

}  // namespace rimlight
