#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/math/vec.h"

namespace rimlight {

/// Linear RGB radiance; row 0 is the top.
struct RgbImage {
  int width = 0;
  int height = 0;
  std::vector<Vec3f> pixels;  // [height][width]

  RgbImage() = default;
  RgbImage(int width_, int height_)
      : width(width_),
        height(height_),
        pixels(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {}

  const Vec3f& at(int x, int y) const {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
  Vec3f& at(int x, int y) { return const_cast<Vec3f&>(std::as_const(*this).at(x, y)); }
};

/// sRGB pixels of 8 bits, interleaved; row 0 is the top.
struct Rgb8Image {
  int width = 0;
  int height = 0;
  AlignedVector<std::uint8_t> bytes;  // [height][width][3]

  Rgb8Image() = default;
  Rgb8Image(int width_, int height_) { resize(width_, height_); }

  /// Keeps the storage when the size is the same.
  void resize(int new_width, int new_height) {
    width = new_width;
    height = new_height;
    bytes.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
  }
};

}  // namespace rimlight
