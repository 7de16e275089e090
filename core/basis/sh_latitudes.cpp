#include "core/basis/sh_latitudes.h"

#include <cmath>
#include <numbers>

#include "core/base/check.h"
#include "core/math/quadrature.h"

namespace rimlight {

ShLatitudes::ShLatitudes(int degree, int exact_degree) {
  RIMLIGHT_CHECK(degree >= 0 && exact_degree >= 0);
  // An even number of points: no latitude is the equator, where the halves would overlap.
  const int points = 2 * (exact_degree / 4 + 1);
  std::vector<double> z;
  for (const QuadraturePoint& point : gauss_legendre(points)) {
    if (!(point.position > 0)) continue;
    z.push_back(point.position);
    weights_.push_back(point.weight);
  }
  RIMLIGHT_CHECK_EQ(2 * z.size(), static_cast<std::size_t>(points));
  values_.resize(static_cast<std::size_t>((degree + 1) * (degree + 2) / 2) * z.size());
  fill(degree, z);
}

/// Normalized throughout, so that nothing overflows: P(m, m) from P(m−1, m−1), and then
/// P(l, m) = a(l, m) · (z P(l−1, m) − P(l−2, m) / a(l−1, m)), a = √((4l² − 1) / (l² − m²)).
void ShLatitudes::fill(int degree, const std::vector<double>& z) {
  const auto factor = [](double l, double m) {
    return std::sqrt((4 * l * l - 1) / (l * l - m * m));
  };
  for (std::size_t i = 0; i < z.size(); ++i) {
    const double sine = std::sqrt((1 - z[i]) * (1 + z[i]));
    double diagonal = std::sqrt(1 / (4 * std::numbers::pi));
    for (int m = 0; m <= degree; ++m) {
      if (m > 0) diagonal *= std::sqrt((2 * m + 1) / (2.0 * m)) * sine;
      row(m, m)[i] = diagonal;
      for (int l = m + 1; l <= degree; ++l) {
        const double before = l == m + 1 ? 0 : row(l - 2, m)[i] / factor(l - 1, m);
        row(l, m)[i] = factor(l, m) * (z[i] * row(l - 1, m)[i] - before);
      }
    }
  }
}

}  // namespace rimlight
