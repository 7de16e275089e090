#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "core/math/vec.h"

namespace rimlight {

/// The directions within `half_angle` radians of a unit axis: the part of the sphere that lamps
/// cover. The default is the whole sphere.
struct SphericalCap {
  Vec3d axis{0, 1, 0};
  double half_angle = std::numbers::pi;

  /// Radians between the axis and a unit direction.
  double angle_to(const Vec3d& direction) const;
  double solid_angle() const;
};

/// Directions closer than this, in radians (20 seconds of arc), count as one that was given several
/// times.
inline constexpr double kCoincident = 1e-4;

/// The spherical Voronoi cells of a set of directions, cut up by the texels of a cube map: which
/// directions are nearest to some part of a texel, and how large that part is.
///
/// A cell is an intersection of half-spaces ω·(p − q) ≥ 0, so on a cube face it is a convex polygon
/// (FacePolygon), and so is its part in a texel; its solid angle is exact to rounding. No
/// triangulation is made, hence none can go wrong: directions on one circle, grids and hemispheres
/// need no care. Squares of the faces are halved until few directions can be nearest inside; p
/// cannot be where ω·(q − p) > 0 for the whole square, that is c·(q − p) > ρ|q − p| with c the
/// square's middle direction and ρ the distance to its farthest corner.
///
/// Coincident directions (kCoincident) share their cell equally. Outside a cap nothing belongs to
/// anything: cells end at its rim (to 1e-6 of the cap's solid angle; exactly for a hemisphere).
class DirectionCells {
 public:
  struct Share {
    std::uint32_t texel;
    double solid_angle;
  };

  /// `directions` at least 1, unit; `size` texels a side, a power of two to cube::kLargestSize.
  /// In parallel; the result does not depend on threads.
  DirectionCells(std::span<const Vec3d> directions, int size, const SphericalCap& cap = {});

  int size() const { return size_; }
  std::size_t direction_count() const { return first_share_.size() - 1; }
  /// Its cell's parts, by texel, ascending. Summed over all directions a texel has its own solid
  /// angle (what of it lies in the cap).
  std::span<const Share> shares(std::size_t direction) const {
    return std::span(shares_).subspan(first_share_[direction],
                                      first_share_[direction + 1] - first_share_[direction]);
  }
  /// Of the whole cell.
  double solid_angle(std::size_t direction) const;

 private:
  int size_;
  std::vector<std::size_t> first_share_;
  std::vector<Share> shares_;
};

}  // namespace rimlight
