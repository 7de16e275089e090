#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/light/cube_light.h"
#include "core/math/camera.h"
#include "core/math/rotation.h"
#include "core/relight/background_kernel.h"
#include "core/transport/receivers.h"

namespace rimlight {

/// An environment ready to be looked up by direction: faces with a border of one texel from their
/// neighbours, so that bilinear look-ups are continuous over the cube's edges. Immutable; any
/// thread.
class BackgroundMap {
 public:
  explicit BackgroundMap(const CubeLight& texels);

  /// Bilinear between texels' middles on the direction's face; any length but zero.
  Vec3f at(const Vec3f& direction) const;
  /// For look_up(), many at once.
  BorderedFaces faces() const { return {texels_.data(), size_}; }

 private:
  int size_;
  AlignedVector<float> texels_;  // [face][row + 1][column + 1][4]
};

/// The pixels that geometry does not cover wholly, by tile, with their rays: the only ones that the
/// environment shows through.
class BackgroundPixels {
 public:
  struct Pixel {
    std::uint16_t x = 0, y = 0;  // in the tile
    float share = 0;             // 1 − coverage
    Vec3f direction;             // unit, through the pixel's middle
  };

  /// `coverage` [height][width] in [0, 1].
  BackgroundPixels(const PixelLayout& layout, const Camera& camera,
                   std::span<const float> coverage);

  std::span<const Pixel> of_tile(std::size_t tile) const {
    return std::span(pixels_).subspan(first_[tile], first_[tile + 1] - first_[tile]);
  }

 private:
  std::vector<std::size_t> first_;  // [tiles + 1]
  std::vector<Pixel> pixels_;
};

}  // namespace rimlight
