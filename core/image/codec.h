#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "core/image/image.h"

namespace rimlight {

/// Compresses frames to JPEG (libjpeg-turbo, 4:2:0), on all cores: in stripes that restart the
/// entropy coder, which decode to the pixels of a file in one piece. Stripes depend on the
/// picture's size alone, and so do the bytes. Keeps its compressors and buffers between calls:
/// allocates nothing after warm-up (libjpeg-turbo's own few pools aside). One thread at a time.
class JpegEncoder {
 public:
  JpegEncoder();
  ~JpegEncoder();
  JpegEncoder(const JpegEncoder&) = delete;
  JpegEncoder& operator=(const JpegEncoder&) = delete;

  /// quality 1 … 100. Replaces `jpeg` with the file's bytes.
  void encode(const Rgb8Image& image, int quality, std::vector<std::uint8_t>& jpeg);

 private:
  class Stripe;
  /// One file of the first `count` stripes; all but the last are of `interval` units of 16×16.
  void join(std::size_t count, int height, int interval, std::vector<std::uint8_t>& jpeg) const;

  std::vector<std::unique_ptr<Stripe>> stripes_;
};

/// Lossless PNG, 8-bit RGB with the sRGB chunk; level 1 with the "up" filter (LIMITS: 8 ms at
/// 512×512 instead of 60). Replaces `png` with the file's bytes.
void encode_png(const Rgb8Image& image, std::vector<std::uint8_t>& png);

/// Decode what the encoders wrote (used by `load` to check frames, and by tests), and any other
/// file of the format, for textures: grey, palettes and 16 bits become 8-bit sRGB, alpha is dropped
/// and does not scale the colour. `source` stands in errors. What check_image_size refuses is
/// refused before allocation; truncation and every warning of the libraries are errors. Throw
/// Error.
Rgb8Image decode_png(const std::uint8_t* bytes, std::size_t size, std::string_view source);
Rgb8Image decode_jpeg(const std::uint8_t* bytes, std::size_t size, std::string_view source);

}  // namespace rimlight
