// A photographer's room: a large warm key, a weak cool fill, two narrow rim lights and an overhead
// strip, all seen from the middle of the room, with a dark neutral sweep around.
#include <algorithm>
#include <cmath>

#include "core/light/builtin_environment_images.h"
#include "core/light/lit_room.h"

namespace rimlight {
namespace {

/// A soft box that faces the room's middle: brightest in its middle, dark at its rim.
RoomLight soft_box(const Vec3d& centre, double half_width, double half_height,
                   const Vec3d& radiance) {
  RoomLight light;
  light.centre = centre;
  const Vec3d facing = normalized(-centre);
  const Vec3d above = std::abs(facing.y) > 0.95 ? Vec3d{0, 0, -1} : Vec3d{0, 1, 0};
  const Vec3d right = normalized(cross(above, facing));
  light.half_right = right * half_width;
  light.half_up = cross(facing, right) * half_height;
  light.mean_radiance = radiance * 0.8;
  const double rim = 0.03 / half_width, rim_up = 0.03 / half_height;  // the black frame
  light.radiance = [radiance, rim, rim_up](double s, double t) {
    if (std::abs(s) > 1 - rim || std::abs(t) > 1 - rim_up) return Vec3d::filled(0.01);
    // The lamp behind the cloth: bright in the middle, falling off towards the rim.
    return radiance * (0.55 + 0.6 * std::exp(-1.4 * (s * s + t * t)));
  };
  return light;
}

double smooth_step(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

Vec3d grey(const WallPoint& point) {
  const double grain = smooth_noise(0.8 * point.s, 0.8 * point.t, 21);
  // A grey paper sweep hangs behind and runs out over the floor; the rest is painted nearly black.
  double paper = 0;
  if (point.position.z < -4.9) paper = 1;
  if (point.normal.y > 0) paper = smooth_step((2.8 - std::abs(point.s)) / 0.5);
  return Vec3d{0.98, 1.0, 1.02} * (std::lerp(0.03, 0.10, paper) * (0.93 + 0.14 * grain));
}

}  // namespace

RgbImage studio_image() {
  LitRoom room;
  room.low = {-5.5, -1.3, -5};
  room.high = {5.5, 3.8, 6};
  room.ambient = Vec3d::filled(0.5);
  room.albedo = grey;
  room.lights = {
      soft_box({2.9, 2.2, -1.0}, 1.0, 0.75, {32, 28.5, 24}),   // key
      soft_box({-3.6, 0.9, 0.6}, 1.1, 1.1, {4.2, 4.8, 5.6}),   // fill
      soft_box({-2.3, 0.8, -3.4}, 0.16, 1.35, {46, 48, 52}),   // rim, left
      soft_box({3.1, 0.6, -3.6}, 0.14, 1.25, {30, 31, 34}),    // rim, right
      soft_box({-0.2, 3.3, -0.5}, 1.5, 0.22, {14, 13.6, 13}),  // overhead
      soft_box({0.8, 1.4, 5.0}, 0.7, 0.5, {6, 5.2, 4.4}),      // behind the camera
  };
  return render_lat_long(2, [&](const Vec3d& direction) { return room.radiance(direction); });
}

}  // namespace rimlight
