#pragma once

#include <ImfHeader.h>
#include <ImfPixelType.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/image/image.h"

namespace rimlight::test {

/// A picture in RGBE: [height][width] of mantissas and exponent.
struct Rgbe {
  std::uint8_t r = 0, g = 0, b = 0, e = 0;
};
struct RgbePicture {
  int width = 0;
  int height = 0;
  std::vector<Rgbe> pixels;
};

/// Normalised random pixels with some runs; exponents from 100 to 160.
RgbePicture random_rgbe(int width, int height, std::uint64_t seed);

std::string hdr_header(std::string_view size_line);
/// The file with run lengths (1991), or flat.
std::string hdr_with_runs(const RgbePicture& picture);
std::string hdr_flat(const RgbePicture& picture);

/// A channel of an EXR file: one value for each pixel of the data window.
struct ExrChannel {
  std::string name;
  Imf::PixelType type = Imf::FLOAT;
  std::vector<float> values;  // stored in `type`
};
/// The file of scan lines, or of tiles when the header has a tile description.
std::string exr_file(Imf::Header header, const std::vector<ExrChannel>& channels);

/// The three channels R, G, B of an image.
std::vector<ExrChannel> rgb_channels(const RgbImage& image, Imf::PixelType type);

/// Uniform in [0, 1).
RgbImage random_image(int width, int height, std::uint64_t seed);
Rgb8Image random_bytes_image(int width, int height, std::uint64_t seed);
/// Smooth with a few edges: something that JPEG is meant for.
Rgb8Image smooth_image(int width, int height);

inline std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

}  // namespace rimlight::test
