#pragma once

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
};

}  // namespace rimlight
