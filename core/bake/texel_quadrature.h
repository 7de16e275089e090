#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/basis/cube_map.h"
#include "core/math/vec.h"

namespace rimlight {

/// A direction inside a texel and the solid angle that it stands for.
struct QuadraturePoint {
  Vec3f direction;
  float solid_angle = 0;
};

/// The quarters of a texel (the texels of a cube map of twice the size): their middles and solid
/// angles, row by row.
inline constexpr std::size_t kQuarters = 4;
using Quarters = std::array<QuadraturePoint, kQuarters>;

/// A texel as a patch of its face's plane: the direction at (u, v) in [0, 1)² is
/// corner + u · across + v · up, which is not of unit length.
struct TexelPatch {
  std::size_t texel = 0;
  Vec3f corner, across, up;
  const Quarters* quarters = nullptr;
};

/// What is asked of each texel of a cube map, over and over. Immutable; any thread.
class TexelQuadrature {
 public:
  explicit TexelQuadrature(int cube_size);

  int cube_size() const { return size_; }
  std::size_t count() const { return quarters_.size(); }
  const Quarters& quarters(std::size_t texel) const { return quarters_[texel]; }
  /// Points into this object.
  TexelPatch patch(std::size_t texel) const;

 private:
  int size_;
  std::vector<Quarters> quarters_;  // [texel]
};

}  // namespace rimlight
