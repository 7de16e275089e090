#include "core/vertices/lobe_curve.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/basis/sh.h"
#include "core/math/quadrature.h"
#include "core/relight/design_state.h"

namespace rimlight {
namespace {

constexpr double kPi = std::numbers::pi;

/// On one piece the integrand is a line times a trigonometric polynomial of degree l + 1; with so
/// many points beyond its degree, Gauss' rule has converged on a quarter turn.
constexpr int kPointsBeyondDegree = 16;

}  // namespace

sh::ZonalLobe curve_lobe(std::span<const double> values, int degree) {
  check_lobe(values, "lobe");
  sh::ZonalLobe lobe(static_cast<std::size_t>(degree) + 1, 0.0);
  const double largest = std::ranges::max(values);  // the tiniest values count as much as others
  const double piece = kPi / 2 / static_cast<double>(values.size() - 1);
  const std::vector<QuadraturePoint> points = gauss_legendre(degree + kPointsBeyondDegree);
  for (std::size_t i = 0; i + 1 < values.size(); ++i) {
    const double first = values[i] / largest, last = values[i + 1] / largest;
    if (first == 0 && last == 0) continue;
    for (const QuadraturePoint& point : points) {
      const double share = (1 + point.position) / 2;
      const double angle = (static_cast<double>(i) + share) * piece;
      const double value = std::lerp(first, last, share) * std::sin(angle) * point.weight;
      const std::vector<double> p = sh::legendre(std::cos(angle), degree);
      for (std::size_t l = 0; l < p.size(); ++l) lobe[l] += value * p[l];
    }
  }
  const double integral = 2 * kPi * lobe[0];  // but for the length of a piece, as all of them are
  for (std::size_t l = 0; l < lobe.size(); ++l) {
    const double axial = std::sqrt((2 * static_cast<double>(l) + 1) / (4 * kPi));  // Y_l0(+z)
    lobe[l] *= 2 * kPi * axial / integral;
  }
  return lobe;
}

}  // namespace rimlight
