#include "core/material/half_difference.h"

#include <cmath>
#include <numbers>

namespace rimlight {

HalfDifference half_difference(const Vec3d& in, const Vec3d& out) {
  const Vec3d sum = in + out;
  const double flat = std::hypot(sum.x, sum.y);
  const double norm = std::hypot(flat, sum.z);
  if (!(norm > 1e-12)) return {std::numbers::pi / 2, std::numbers::pi / 2, 0};
  const Vec3d half = sum / norm;
  const Vec3d difference = in - out;
  // in − out is orthogonal to the half vector, and 2 sin θ_d long. Of the frame's two axes across
  // the half vector, one lies in the plane of it and the normal, and leans down.
  const double cosine = flat > 0 ? sum.x / flat : 1, sine = flat > 0 ? sum.y / flat : 0;
  const Vec3d down{half.z * cosine, half.z * sine, -flat / norm};
  const Vec3d across{-sine, cosine, 0};
  return {std::atan2(flat, sum.z), std::atan2(length(difference), norm),
          std::atan2(dot(difference, across), dot(difference, down))};
}

DirectionPair direction_pair(const HalfDifference& angles) {
  const double sine_h = std::sin(angles.half), cosine_h = std::cos(angles.half);
  const double sine_d = std::sin(angles.difference), cosine_d = std::cos(angles.difference);
  const Vec3d half{sine_h, 0, cosine_h};
  const Vec3d down{cosine_h, 0, -sine_h};
  const Vec3d across{0, 1, 0};
  const Vec3d offset =
      (down * std::cos(angles.azimuth) + across * std::sin(angles.azimuth)) * sine_d;
  return {half * cosine_d + offset, half * cosine_d - offset};
}

}  // namespace rimlight
