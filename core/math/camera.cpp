#include "core/math/camera.h"

#include <cmath>
#include <numbers>

#include "core/base/error.h"

namespace rimlight {
namespace {

constexpr double kFarthest = 1e9;      // squares and their sums stay far from overflow
constexpr double kNearest = 1e-9;      // a shorter way or up has no direction to trust
constexpr double kLeastAcross = 1e-6;  // sine of the angle between view and up

bool is_in_reach(const Vec3d& v) {
  return std::abs(v.x) <= kFarthest && std::abs(v.y) <= kFarthest && std::abs(v.z) <= kFarthest;
}

}  // namespace

Vec3d Camera::ray_direction(double x, double y, int width, int height) const {
  return CameraRays(*this, width, height).direction(x, y);
}

CameraRays::CameraRays(const Camera& camera, int width, int height)
    : origin_(camera.position),
      forward_(normalized(camera.target - camera.position)),
      right_(normalized(cross(forward_, camera.up))),
      above_(cross(right_, forward_)),
      half_(std::tan(camera.vertical_field_of_view_degrees * std::numbers::pi / 360)),
      width_(width),
      height_(height) {}

Vec3d CameraRays::direction(double x, double y) const {
  const double s = (2 * x - width_) / height_ * half_;
  const double t = (height_ - 2 * y) / height_ * half_;
  return normalized(forward_ + right_ * s + above_ * t);
}

void check_camera(const Camera& camera, const std::string& where) {
  const auto check = [&where](bool good, const char* field, const char* found,
                              const std::string& expected) {
    if (!good) throw Error(where + field, found, expected);
  };
  const char* const kNoNumber = "a number that is not finite, or huge";
  const std::string reach = "three numbers within 1e9";
  check(is_in_reach(camera.position), "/position", kNoNumber, reach);
  check(is_in_reach(camera.target), "/target", kNoNumber, reach);
  check(is_in_reach(camera.up), "/up", kNoNumber, reach);
  const double angle = camera.vertical_field_of_view_degrees;
  check(angle >= kLeastFieldOfView && angle <= kMostFieldOfView, "/field_of_view",
        "an angle out of range", "1 to 170 degrees");
  const Vec3d way = camera.target - camera.position;
  check(length(way) > kNearest, "/target", "the position itself",
        "a point other than the position");
  const double up_length = length(camera.up);
  check(up_length > kNearest &&
            length(cross(way, camera.up)) > kLeastAcross * length(way) * up_length,
        "/up", "no direction across the view", "a direction that is not along the view");
}

}  // namespace rimlight
