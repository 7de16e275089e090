#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "core/image/image.h"

namespace rimlight {

/// Whether this build has VP8 (RIMLIGHT_VP8). Without it the constructors below throw Error.
bool has_vp8();

/// How a frame of a stream hangs together with those before it. A decoder keeps two pictures: the
/// last and the golden one. It can decode a frame when it has what the frame is predicted from,
/// whatever else it has missed since its last key frame.
struct Vp8Links {
  bool from_last = false, from_golden = false;  // predicted from; neither: a key frame
  bool to_last = true, to_golden = false;       // kept as; a key frame is kept as both

  bool is_key() const { return !from_last && !from_golden; }
  friend bool operator==(const Vp8Links&, const Vp8Links&) = default;
};

/// A VP8 stream of one size and one quality (libvpx, real-time mode, one thread; BT.601 in 16 to
/// 235, 4:2:0, as browsers take it). Frames are never dropped or held back: each gives one frame's
/// bytes. No frame changes the entropy coder's tables for later ones, so that only the pictures
/// named by Vp8Links tie frames together (RFC 6386, sections 9.7 and 9.11). Allocates nothing
/// after the first frame. One thread at a time.
class Vp8Encoder {
 public:
  static constexpr int kLargestSide = 16383;  // 14 bits in a key frame
  static constexpr int kCoarsest = 63;        // quantizer; 0 is the finest

  /// Throws Error for sides outside 1 … kLargestSide or a quantizer outside 0 … kCoarsest.
  Vp8Encoder(int width, int height, int quantizer);
  ~Vp8Encoder();
  Vp8Encoder(const Vp8Encoder&) = delete;
  Vp8Encoder& operator=(const Vp8Encoder&) = delete;

  /// Replaces `frame`. The picture has the stream's size. The first frame is a key frame, and must
  /// be asked for as one.
  void encode(const Rgb8Image& picture, const Vp8Links& links, std::vector<std::uint8_t>& frame);

 private:
  class State;
  std::unique_ptr<State> state_;
};

/// Decodes such a stream, as a browser does: used by `load` and by tests. One thread at a time.
class Vp8Decoder {
 public:
  Vp8Decoder();
  ~Vp8Decoder();
  Vp8Decoder(const Vp8Decoder&) = delete;
  Vp8Decoder& operator=(const Vp8Decoder&) = delete;

  /// Replaces `picture`. Throws Error naming `source`: damage that libvpx sees, no key frame
  /// before, a size that check_image_size refuses (before anything is allocated).
  void decode(std::span<const std::uint8_t> frame, std::string_view source, Rgb8Image& picture);

 private:
  class State;
  std::unique_ptr<State> state_;
};

}  // namespace rimlight
