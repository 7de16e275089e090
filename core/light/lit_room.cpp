#include "core/light/lit_room.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace rimlight {

WallPoint LitRoom::wall(const Vec3d& direction) const {
  double nearest = std::numeric_limits<double>::infinity();
  int axis = 0;
  for (int i = 0; i < 3; ++i) {
    if (direction[i] == 0) continue;
    const double distance = (direction[i] > 0 ? high[i] : low[i]) / direction[i];
    if (distance < nearest) {
      nearest = distance;
      axis = i;
    }
  }
  WallPoint point;
  point.position = direction * nearest;
  point.normal[axis] = direction[axis] > 0 ? -1 : 1;
  point.s = axis == 0 ? point.position.z : point.position.x;
  point.t = axis == 1 ? point.position.z : point.position.y;
  return point;
}

Vec3d LitRoom::irradiance(const WallPoint& point) const {
  Vec3d sum = ambient;
  for (const RoomLight& light : lights) {
    const Vec3d across = cross(light.half_right, light.half_up);  // a quarter of its area long
    const Vec3d to_light = light.centre - point.position;
    // Its own size keeps a wall right behind or beside it from a pole.
    const double size = dot(light.half_right, light.half_right) + dot(light.half_up, light.half_up);
    const double square = dot(to_light, to_light);
    const double towards_wall = std::max(-dot(to_light, across), 0.0);
    const double towards_light = std::max(dot(to_light, point.normal), 0.0);
    sum += light.mean_radiance * (4 * towards_wall * towards_light / (square * (square + size)));
  }
  return sum;
}

Vec3d LitRoom::radiance(const Vec3d& direction) const {
  double nearest = std::numeric_limits<double>::infinity();
  std::optional<Vec3d> seen;
  for (const RoomLight& light : lights) {
    const Vec3d across = cross(light.half_right, light.half_up);
    const double approach = dot(direction, across);
    if (!(approach < 0)) continue;  // from behind
    const double distance = dot(light.centre, across) / approach;
    if (!(distance > 0 && distance < nearest)) continue;
    const Vec3d offset = direction * distance - light.centre;
    const double s = dot(offset, light.half_right) / dot(light.half_right, light.half_right);
    const double t = dot(offset, light.half_up) / dot(light.half_up, light.half_up);
    if (std::abs(s) > 1 || std::abs(t) > 1) continue;
    const std::optional<Vec3d> value = light.radiance(s, t);
    if (!value) continue;
    nearest = distance;
    seen = value;
  }
  if (seen) return *seen;
  const WallPoint point = wall(direction);
  return albedo(point) * irradiance(point) / std::numbers::pi;
}

}  // namespace rimlight
