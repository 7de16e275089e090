#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/math/vec.h"

namespace rimlight {

/// A box-shaped room around the observer at the origin, lit by rectangles: enough of a scene to
/// make the environments "studio" and "cathedral" from.

/// A point of a wall; `normal` points into the room. (s, t) are lengths along the wall: t is the
/// height on the four sides, s runs along them.
struct WallPoint {
  Vec3d position, normal;
  double s = 0, t = 0;
};

/// A rectangle that sends out light to the side that it faces.
struct RoomLight {
  Vec3d centre;
  Vec3d half_right, half_up;  // half its sides; right × up is where it faces
  Vec3d mean_radiance;        // for what it does to the walls
  /// Radiance at (s, t) in [−1, 1]²; nothing where the light has a gap and one sees past it.
  std::function<std::optional<Vec3d>(double s, double t)> radiance;
};

struct LitRoom {
  Vec3d low, high;
  std::vector<RoomLight> lights;
  Vec3d ambient;  // irradiance that reaches every wall
  std::function<Vec3d(const WallPoint&)> albedo;

  /// What the observer sees: the nearest light before the wall, or the wall, which reflects the
  /// lights (each as a point at its middle) and the ambient light as a Lambert surface.
  Vec3d radiance(const Vec3d& direction) const;

  WallPoint wall(const Vec3d& direction) const;
  Vec3d irradiance(const WallPoint& point) const;
};

}  // namespace rimlight
