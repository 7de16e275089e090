#include "core/basis/sh_zonal.h"

#include <cmath>
#include <numbers>
#include <string>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/basis/sh.h"
#include "core/math/quadrature.h"

namespace rimlight::sh {
namespace {

constexpr double kPi = std::numbers::pi;

/// Y_l0(+z).
double axial_value(int l) { return std::sqrt((2 * l + 1) / (4 * kPi)); }

/// A lobe's degree, from its number of coefficients.
int degree_of_lobe(std::size_t size) {
  RIMLIGHT_CHECK(size >= 1);
  RIMLIGHT_CHECK(size <= static_cast<std::size_t>(kLargestLightDegree) + 1);
  return static_cast<int>(size) - 1;
}

/// The coefficients of scale · max(t, 0)^s.
ZonalLobe power_lobe(double exponent, double scale, int degree) {
  check_degree(degree);
  ZonalLobe lobe;
  double integral[2] = {scale / (exponent + 1), scale / (exponent + 2)};  // of even and odd degree
  for (int l = 0; l <= degree; ++l) {
    double& of_parity = integral[l % 2];
    if (l >= 2) of_parity *= (exponent - l + 2) / (exponent + l + 1);
    lobe.push_back(2 * kPi * axial_value(l) * of_parity);
  }
  return lobe;
}

}  // namespace

ZonalLobe clamped_cosine_lobe(int degree) { return power_lobe(1, 1, degree); }

ZonalLobe phong_lobe(double exponent, int degree) {
  RIMLIGHT_CHECK(std::isfinite(exponent));
  RIMLIGHT_CHECK(exponent >= 0);
  return power_lobe(exponent, (exponent + 1) / (2 * kPi), degree);
}

ZonalLobe sampled_lobe(const std::function<double(double)>& lobe, int degree, int points) {
  check_degree(degree);
  RIMLIGHT_CHECK(points >= 1);
  ZonalLobe result(static_cast<std::size_t>(degree) + 1, 0.0);
  for (const QuadraturePoint& point : gauss_legendre(points)) {
    for (const double middle : {-0.5, 0.5}) {
      const double cosine = middle + 0.5 * point.position;
      const double value = lobe(cosine);
      if (!std::isfinite(value)) {
        throw Error("lobe", std::to_string(value) + " at cosine " + std::to_string(cosine),
                    "a finite value");
      }
      const std::vector<double> p = legendre(cosine, degree);
      for (std::size_t l = 0; l < p.size(); ++l) result[l] += 0.5 * point.weight * value * p[l];
    }
  }
  for (int l = 0; l <= degree; ++l) result[static_cast<std::size_t>(l)] *= 2 * kPi * axial_value(l);
  return result;
}

double lobe_value(std::span<const double> lobe, double cosine) {
  const int degree = degree_of_lobe(lobe.size());
  const std::vector<double> p = legendre(cosine, degree);
  double sum = 0;
  for (int l = 0; l <= degree; ++l) {
    const auto i = static_cast<std::size_t>(l);
    sum += lobe[i] * axial_value(l) * p[i];
  }
  return sum;
}

std::vector<double> turned_lobe(std::span<const double> lobe, const Vec3d& axis) {
  const int degree = degree_of_lobe(lobe.size());
  std::vector<double> coefficients = evaluate(axis, degree);
  for (int l = 0; l <= degree; ++l) {
    const double factor = lobe[static_cast<std::size_t>(l)] / axial_value(l);
    for (int m = -l; m <= l; ++m) coefficients[index(l, m)] *= factor;
  }
  return coefficients;
}

void convolve(std::span<const double> lobe, std::span<float> signals) {
  const int degree = degree_of_lobe(lobe.size());
  std::vector<double> factors(lobe.begin(), lobe.end());
  for (int l = 0; l <= degree; ++l) factors[static_cast<std::size_t>(l)] /= axial_value(l);
  scale_bands(factors, signals);
}

void scale_bands(std::span<const double> factors, std::span<float> signals) {
  const std::size_t count = coefficient_count(degree_of_lobe(factors.size()));
  RIMLIGHT_CHECK_EQ(signals.size() % count, std::size_t{0});
  std::size_t i = 0;
  while (i < signals.size()) {
    for (std::size_t l = 0; l < factors.size(); ++l) {
      for (const std::size_t end = i + 2 * l + 1; i < end; ++i) {
        signals[i] = static_cast<float>(factors[l] * static_cast<double>(signals[i]));
      }
    }
  }
}

}  // namespace rimlight::sh
