#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

#include "core/basis/sh_tripling.h"
#include "core/math/quadrature.h"
#include "core/math/random.h"

namespace rimlight::test {

/// All real harmonics at a direction, in double, from the standard library's spherical Legendre
/// functions, whose Condon–Shortley phase is taken out.
inline std::vector<double> harmonics_at(int degree, const Vec3d& direction) {
  const double theta = std::acos(std::fmin(std::fmax(direction.z, -1.0), 1.0));
  const double phi = std::atan2(direction.y, direction.x);
  std::vector<double> values(sh::coefficient_count(degree));
  for (int l = 0; l <= degree; ++l) {
    for (int m = 0; m <= l; ++m) {
      const double latitude =
          std::sph_legendre(static_cast<unsigned>(l), static_cast<unsigned>(m), theta) *
          (m % 2 == 0 ? 1 : -1) * (m == 0 ? 1 : std::numbers::sqrt2);
      if (m > 0) values[sh::index(l, -m)] = latitude * std::sin(m * phi);
      values[sh::index(l, m)] = latitude * std::cos(m * phi);
    }
  }
  return values;
}

template <typename T>
double sum_of_products(std::span<const double> harmonics, std::span<const T> coefficients) {
  double sum = 0;
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    sum += harmonics[i] * static_cast<double>(coefficients[i]);
  }
  return sum;
}

/// The projected product of two functions by brute force: both are summed up at each point of a
/// quadrature that is exact for the degrees, multiplied, and projected.
template <typename T>
std::vector<double> brute_force_product(std::span<const T> f, std::span<const T> g,
                                        int product_degree) {
  const auto degree_of = [](std::size_t count) {
    return static_cast<int>(std::lround(std::sqrt(static_cast<double>(count)))) - 1;
  };
  const int f_degree = degree_of(f.size()), g_degree = degree_of(g.size());
  const int most = std::max({f_degree, g_degree, product_degree});
  const int points = (f_degree + g_degree + product_degree) / 2 + 1;
  std::vector<double> product(sh::coefficient_count(product_degree));
  for (const QuadraturePoint& point : gauss_legendre(points)) {
    const double r = std::sqrt(1 - point.position * point.position);
    for (int turn = 0; turn < 2 * points; ++turn) {
      const double phi = std::numbers::pi * (turn + 0.5) / points;
      const auto harmonics =
          harmonics_at(most, {r * std::cos(phi), r * std::sin(phi), point.position});
      const double value = point.weight * std::numbers::pi / points *
                           sum_of_products<T>(harmonics, f) * sum_of_products<T>(harmonics, g);
      for (std::size_t i = 0; i < product.size(); ++i) product[i] += value * harmonics[i];
    }
  }
  return product;
}

inline std::vector<float> random_coefficients(int degree, std::uint64_t seed) {
  Random random(seed);
  std::vector<float> values(sh::coefficient_count(degree));
  for (float& value : values) value = static_cast<float>(random.uniform(-1, 1));
  return values;
}

}  // namespace rimlight::test
