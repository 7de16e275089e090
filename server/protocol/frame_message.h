#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/protocol/messages.h"

namespace rimlight::server {

enum class Codec { jpeg, png };

/// What a frame says of itself: the JSON header of a binary message (docs/protocol).
struct FrameHeader {
  std::int64_t frame = 0;  // counts a session's frames
  Revision revision;       // the state it shows
  Codec codec = Codec::jpeg;
  int width = 0;
  int height = 0;
  bool exact = false;
  std::int64_t terms = 0;            // columns applied
  double residual = 0;               // ‖target − held‖₁ / ‖target‖₁ of the lighting
  std::optional<double> estimate;    // relative L2 error of the image, estimated
  std::vector<std::string> unshown;  // what the state asks for and the image does not show
  double queue_ms = 0;               // from when the frame was wanted to when its work began
  double rotate_ms = 0;
  double update_ms = 0;
  double display_ms = 0;
  double encode_ms = 0;

  friend bool operator==(const FrameHeader&, const FrameHeader&) = default;
};

/// One binary message, whole: encoded once, shared by all clients of the session.
///   u32 little-endian header length, JSON header, payload
struct FrameMessage {
  std::int64_t frame = 0;
  std::vector<std::uint8_t> bytes;
};
using FramePtr = std::shared_ptr<const FrameMessage>;

/// Of `unshown` so many are written, each cut to so many bytes; the last says how many there were
/// more.
inline constexpr std::size_t kMostUnshown = 16, kLongestUnshown = 320;

FramePtr write_frame_message(const FrameHeader& header, std::span<const std::uint8_t> payload);

struct ParsedFrame {
  FrameHeader header;
  std::span<const std::uint8_t> payload;  // into the message
};

/// Reads what write_frame_message wrote. Throws Error naming `source`: lengths that do not fit, a
/// malformed header, or a field out of range.
ParsedFrame parse_frame_message(std::span<const std::uint8_t> message, const std::string& source);

}  // namespace rimlight::server
