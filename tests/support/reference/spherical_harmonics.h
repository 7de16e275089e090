#pragma once

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <vector>

#include "core/math/vec.h"

namespace rimlight::reference {

/// P_l^m without the Condon–Shortley phase, by the textbook recurrence, from the angle's cosine and
/// sine.
inline long double associated_legendre(int l, int m, long double cosine, long double sine) {
  long double value = 1, before = 0;
  for (int k = 1; k <= m; ++k) value *= static_cast<long double>(2 * k - 1) * sine;
  for (int k = m + 1; k <= l; ++k) {
    const long double next = (static_cast<long double>(2 * k - 1) * cosine * value -
                              static_cast<long double>(k + m - 1) * before) /
                             static_cast<long double>(k - m);
    before = value;
    value = next;
  }
  return value;
}

/// Y_lm at a direction of any length, from its definition in angles with plain factorials, in long
/// double: no part is shared with core/basis.
inline double spherical_harmonic(int l, int m, const Vec3d& direction) {
  const long double x = direction.x, y = direction.y, z = direction.z;
  const long double across = std::hypot(x, y), length = std::hypot(x, y, z);
  const int order = std::abs(m);
  long double factorials = 1;  // (l + |m|)! / (l − |m|)!
  for (int k = l - order + 1; k <= l + order; ++k) factorials *= static_cast<long double>(k);
  const long double scale =
      std::sqrt(static_cast<long double>(2 * l + 1) /
                (4 * std::numbers::pi_v<long double>)*(m == 0 ? 1 : 2) / factorials);
  const long double angle = static_cast<long double>(order) * std::atan2(y, x);
  const long double around = m < 0 ? std::sin(angle) : std::cos(angle);
  return static_cast<double>(scale * associated_legendre(l, order, z / length, across / length) *
                             around);
}

inline std::vector<double> spherical_harmonics(const Vec3d& direction, int degree) {
  std::vector<double> values;
  for (int l = 0; l <= degree; ++l) {
    for (int m = -l; m <= l; ++m) values.push_back(spherical_harmonic(l, m, direction));
  }
  return values;
}

}  // namespace rimlight::reference
