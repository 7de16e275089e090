#pragma once

#include <cstddef>
#include <span>

#include "core/base/aligned_vector.h"
#include "core/basis/cube_map.h"
#include "core/math/vec.h"

namespace rimlight {

/// One float for each channel and texel (or coefficient) of a cube map: planar [3][count].
/// As texels: each the mean radiance over the texel's solid angle (see CubeHaar).
struct CubeLight {
  int size = 0;
  AlignedVector<float> values;  // [3][texel_count(size)]

  CubeLight() = default;
  explicit CubeLight(int size_) : size(size_), values(3 * cube::texel_count(size_)) {}

  std::size_t count() const { return values.size() / 3; }
  std::span<float> channel(int c) {
    return {values.data() + static_cast<std::size_t>(c) * count(), count()};
  }
  std::span<const float> channel(int c) const {
    return {values.data() + static_cast<std::size_t>(c) * count(), count()};
  }
  Vec3f at(std::size_t i) const {
    return {values[i], values[count() + i], values[2 * count() + i]};
  }
};

/// ∫ L dω over the sphere, per channel, in double.
Vec3d integral(const CubeLight& light);

}  // namespace rimlight
