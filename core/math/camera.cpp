#include "core/math/camera.h"

#include <cmath>
#include <numbers>

namespace rimlight {

Vec3d Camera::ray_direction(double x, double y, int width, int height) const {
  const Vec3d forward = normalized(target - position);
  const Vec3d right = normalized(cross(forward, up));
  const Vec3d above = cross(right, forward);
  const double half = std::tan(vertical_field_of_view_degrees * std::numbers::pi / 360);
  const double s = (2 * x - width) / height * half;
  const double t = (height - 2 * y) / height * half;
  return normalized(forward + right * s + above * t);
}

}  // namespace rimlight
