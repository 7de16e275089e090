#pragma once

#include <string>

#include "core/math/vec.h"

namespace rimlight {

/// A pinhole camera: ray through pixel (x, y) of width × height, x right, y down, pixel middles at
/// +0.5.
struct Camera {
  Vec3d position{0, 0, 5};
  Vec3d target{0, 0, 0};
  Vec3d up{0, 1, 0};
  double vertical_field_of_view_degrees = 40;

  /// The unit direction of the ray through a point of the image.
  Vec3d ray_direction(double x, double y, int width, int height) const;

  friend bool operator==(const Camera&, const Camera&) = default;
};

/// A camera's axes for one size of image, found once for many rays: the same directions as
/// Camera::ray_direction(), bit for bit. The camera must have passed check_camera().
class CameraRays {
 public:
  CameraRays(const Camera& camera, int width, int height);

  const Vec3d& origin() const { return origin_; }
  /// The unit direction through a point of the image.
  Vec3d direction(double x, double y) const;

 private:
  Vec3d origin_, forward_, right_, above_;
  double half_;  // tan of half the field of view
  int width_, height_;
};

/// The field of view that a camera may have, in degrees.
inline constexpr double kLeastFieldOfView = 1, kMostFieldOfView = 170;

/// Throws Error, naming `where` and the field, for a camera that has no rays: a number that is not
/// finite or beyond 10⁹, a target at the position, an up direction that is zero or along the view,
/// a field of view out of range.
void check_camera(const Camera& camera, const std::string& where);

}  // namespace rimlight
