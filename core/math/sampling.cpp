#include "core/math/sampling.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rimlight {

Sample2 random_sample(Random& random) {
  const double u = random.uniform();
  return {u, random.uniform()};
}

Sample2 r2_point(const Sample2& shift, int i) {
  constexpr double kStepU = 0.7548776662466927;
  constexpr double kStepV = 0.5698402909980532;
  const double u = shift.u + i * kStepU;
  const double v = shift.v + i * kStepV;
  return {u - std::floor(u), v - std::floor(v)};
}

Vec3d uniform_sphere(const Sample2& sample) {
  const double z = 1 - 2 * sample.u;
  const double r = std::sqrt(std::max(0.0, 1 - z * z));
  const double phi = 2 * std::numbers::pi * sample.v;
  return {r * std::cos(phi), r * std::sin(phi), z};
}

DiscPoint uniform_disc(const Sample2& sample) {
  const double a = 2 * sample.u - 1;
  const double b = 2 * sample.v - 1;
  if (a == 0 && b == 0) return {};
  const bool wide = std::abs(a) > std::abs(b);
  const double r = wide ? a : b;
  const double phi =
      wide ? std::numbers::pi / 4 * (b / a) : std::numbers::pi / 2 - std::numbers::pi / 4 * (a / b);
  return {r * std::cos(phi), r * std::sin(phi)};
}

Vec3d cosine_hemisphere(const Sample2& sample) {
  const DiscPoint p = uniform_disc(sample);
  return {p.x, p.y, std::sqrt(std::max(0.0, 1 - p.x * p.x - p.y * p.y))};
}

}  // namespace rimlight
