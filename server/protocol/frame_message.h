#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/protocol/messages.h"

namespace rimlight::server {

enum class Codec { jpeg, png, vp8 };

/// The bytes of a lossless image that a frame message has, when they come in several.
struct FramePart {
  std::size_t offset = 0;
  std::size_t size = 0;  // of the whole image

  friend bool operator==(const FramePart&, const FramePart&) = default;
};

/// What a frame says of itself: the JSON header of a binary message (docs/protocol).
struct FrameHeader {
  std::int64_t frame = 0;  // counts a session's frames
  Revision revision;       // the state it shows
  Codec codec = Codec::jpeg;
  int width = 0;  // of this image: may be smaller than the session's
  int height = 0;
  bool exact = false;
  bool key = true;                   // can be decoded without any before it
  std::optional<int> rung;           // of kRungs; none of exact frames
  std::optional<int> quality;        // of JPEG 1 … 100; of VP8 the quantizer 0 … 63
  std::optional<FramePart> part;     // none: the image is whole
  std::int64_t terms = 0;            // columns applied
  double residual = 0;               // ‖target − held‖₁ / ‖target‖₁ of the lighting
  std::optional<double> estimate;    // relative L2 error of the image, estimated
  std::vector<std::string> unshown;  // what the state asks for and the image does not show
  double queue_ms = 0;               // from when the frame was wanted to when its work began
  double rotate_ms = 0;
  double update_ms = 0;
  double display_ms = 0;
  double encode_ms = 0;
  double wait_ms = 0;  // from when it was encoded to when it was sent to this client

  friend bool operator==(const FrameHeader&, const FrameHeader&) = default;
};

/// An encoded image, made once for all who want the same.
using Payload = std::shared_ptr<const std::vector<std::uint8_t>>;

/// One binary message, whole: what is said to one client of an image that many share.
///   u32 little-endian header length, JSON header, payload
struct FrameMessage {
  std::int64_t frame = 0;
  std::vector<std::uint8_t> head;  // the length and the header
  Payload payload;
  std::size_t first = 0, count = 0;  // the bytes of the payload that it has

  std::span<const std::uint8_t> body() const { return std::span(*payload).subspan(first, count); }
  std::size_t size() const { return head.size() + count; }
  /// The message in one piece.
  std::vector<std::uint8_t> bytes() const;
};
using FramePtr = std::shared_ptr<const FrameMessage>;

/// Of `unshown` so many are written, each cut to so many bytes; the last says how many there were
/// more.
inline constexpr std::size_t kMostUnshown = 16, kLongestUnshown = 320;

/// The message of the whole payload, or of the `bytes` at header.part's offset.
FramePtr write_frame_message(const FrameHeader& header, Payload payload);
FramePtr write_frame_message(const FrameHeader& header, Payload payload, std::size_t bytes);

struct ParsedFrame {
  FrameHeader header;
  std::span<const std::uint8_t> payload;  // into the message
};

/// Reads what write_frame_message wrote. Throws Error naming `source`: lengths that do not fit, a
/// malformed header, or a field out of range.
ParsedFrame parse_frame_message(std::span<const std::uint8_t> message, const std::string& source);

}  // namespace rimlight::server
