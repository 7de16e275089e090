#pragma once

#include <cstddef>
#include <span>

#include "core/base/aligned_vector.h"
#include "core/math/vec.h"

namespace rimlight::sh {

/// Directions go through the kernels in whole groups of so many.
inline constexpr std::size_t kDirectionLanes = 16;

/// `count` rounded up to whole lanes.
constexpr std::size_t padded(std::size_t count) {
  return (count + kDirectionLanes - 1) / kDirectionLanes * kDirectionLanes;
}

/// Directions of any length but zero, as structure of arrays: each span of one size, a multiple of
/// kDirectionLanes, 64-byte aligned.
struct DirectionSpans {
  std::span<const float> x, y, z;
};

/// Directions that own their memory, padded with +z. The padding's values must get weight zero.
class Directions {
 public:
  Directions() = default;
  explicit Directions(std::span<const Vec3d> directions);

  std::size_t count() const { return count_; }
  Vec3f at(std::size_t i) const { return {x_[i], y_[i], z_[i]}; }
  /// From `first`, a multiple of kDirectionLanes, at most `count` of them, padded.
  DirectionSpans part(std::size_t first, std::size_t count) const;
  DirectionSpans all() const { return {x_, y_, z_}; }

 private:
  AlignedVector<float> x_, y_, z_;
  std::size_t count_ = 0;
};

}  // namespace rimlight::sh
