// Spherical harmonics to their highest degree: poles, products, a sun that rings.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/basis/sh.h"
#include "core/basis/sh_kernel.h"
#include "core/basis/sh_product.h"
#include "core/basis/sh_projection.h"
#include "core/basis/sh_window.h"
#include "core/basis/sh_zonal.h"
#include "core/math/random.h"
#include "core/math/sampling.h"
#include "core/report/stability/cases.h"

namespace rimlight::stability {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kHighest = sh::kLargestLightDegree;

/// Y_l0(±z) = √((2l + 1)/4π) (±1)^l, all others are 0.
double pole_value(int l, int m, bool north) {
  if (m != 0) return 0;
  return std::sqrt((2 * l + 1) / (4 * kPi)) * (north || l % 2 == 0 ? 1 : -1);
}

StabilityMeasure poles(const StabilityTrial& trial) {
  double worst = 0;
  for (const double z : {1.0, -1.0}) {
    for (const double length : {1.0, 1e-100, 1e100}) {
      const auto values = sh::evaluate({trial.either(0.0, 1e-9) * length, 0, z * length}, kHighest);
      for (int l = 0; l <= kHighest; ++l) {
        for (int m = -l; m <= l; ++m) {
          worst = std::max(worst, std::abs(values[sh::index(l, m)] - pole_value(l, m, z > 0)));
        }
      }
    }
  }
  return {worst};
}

StabilityMeasure poles_in_floats(const StabilityTrial& trial) {
  const std::vector<Vec3d> directions = {{0, 0, 1}, {trial.either(0.0, 1e-4), 0, -1}};
  const sh::Directions packed(directions);
  const std::size_t stride = sh::padded(directions.size());
  AlignedVector<float> values(sh::coefficient_count(kHighest) * stride);
  sh::evaluate(packed.all(), kHighest, values, stride);
  double worst = 0;
  for (int l = 0; l <= kHighest; ++l) {
    for (int m = -l; m <= l; ++m) {
      for (std::size_t d = 0; d < 2; ++d) {
        const double value = values[sh::index(l, m) * stride + d];
        worst = std::max(worst, std::abs(value - pole_value(l, m, d == 0)));
      }
    }
  }
  return {worst};
}

/// Σ_m Y_lm² = (2l + 1)/4π at any direction, the nearest to a pole included.
StabilityMeasure addition_theorem(const StabilityTrial& trial) {
  Random random(1);
  double worst = 0;
  for (int i = 0; i < (trial.fast ? 50 : 2000); ++i) {
    Vec3d direction = uniform_sphere(random_sample(random));
    if (i % 2 == 0) {  // 1e-1 to 1e-16 from a pole
      const double off = std::pow(10, random.uniform(-16, -1));
      direction = {off * direction.x, off * direction.y, direction.z > 0 ? 1.0 : -1.0};
    }
    const auto values = sh::evaluate(direction, kHighest);
    for (int l = 0; l <= kHighest; ++l) {
      double sum = 0;
      for (int m = -l; m <= l; ++m) sum += values[sh::index(l, m)] * values[sh::index(l, m)];
      const double expected = (2 * l + 1) / (4 * kPi) * trial.either(1.0, 1 + 1e-9);
      worst = std::max(worst, std::abs(sum / expected - 1));
    }
  }
  return {worst};
}

/// A sun's coefficients: a point of light along a direction, of mean 1.
std::vector<float> sun(int degree) {
  const auto values = sh::evaluate({0.3, -0.5, 0.7}, degree);
  std::vector<float> coefficients(values.begin(), values.end());
  for (float& value : coefficients) value *= static_cast<float>(4 * kPi);
  return coefficients;
}

/// The least value of a reconstruction on a fine grid of directions, and its largest.
struct Swing {
  double least = 0, largest = 0;
};

Swing swing_of(const std::vector<float>& coefficients, int degree) {
  std::vector<Vec3d> directions;
  const Sample2 shift;
  for (int i = 0; i < 40'000; ++i) directions.push_back(uniform_sphere(r2_point(shift, i)));
  const auto values = sh::reconstruct(coefficients, degree, sh::Directions(directions));
  const auto [least, largest] = std::ranges::minmax_element(values);
  return {*least, *largest};
}

StabilityMeasure ringing_sun(const StabilityTrial& trial) {
  double worst = 0;
  std::string note = "below zero without and with the window, of the mean:";
  for (const int degree : {4, 10, 20}) {
    std::vector<float> light = sun(degree);
    const double without = -swing_of(light, degree).least;
    const sh::FittedWindow window = sh::fitted_window(light);
    if (!trial.broken) sh::scale_bands(window.factors, light);
    const double with = -swing_of(light, degree).least;
    note += " " + std::to_string(without) + " " + std::to_string(with);
    worst = std::max(worst, with);
  }
  return {worst, note};
}

StabilityMeasure ringing_hann(const StabilityTrial& trial) {
  double worst = 0;
  for (const int degree : {10, 20, 32}) {
    std::vector<float> light = sun(degree);
    const auto window = trial.either(sh::Window::hann, sh::Window::none);
    sh::scale_bands(sh::window_factors(window, degree), light);
    const Swing swing = swing_of(light, degree);
    worst = std::max(worst, -swing.least / swing.largest);
  }
  return {worst};
}

std::vector<float> random_signal(int degree, std::uint64_t seed) {
  std::vector<float> values(sh::coefficient_count(degree));
  Random random(seed);
  for (float& value : values) value = static_cast<float>(random.uniform(-1, 1));
  return values;
}

double norm_of(const std::vector<float>& values) {
  double sum = 0;
  for (const float value : values) sum += double{value} * double{value};
  return std::sqrt(sum);
}

/// The value of a signal at a direction, in double.
double value_at(const std::vector<float>& coefficients, int degree, const Vec3d& direction) {
  const auto basis = sh::evaluate(direction, degree);
  double sum = 0;
  for (std::size_t i = 0; i < basis.size(); ++i) sum += basis[i] * double{coefficients[i]};
  return sum;
}

/// Two functions of degree 32 and their product of degree 64, value by value.
StabilityMeasure product_of_two_high(const StabilityTrial& trial) {
  constexpr int kDegree = sh::kLargestDegree;
  const ShProduct multiply({kDegree, kDegree, kHighest});
  const auto first = random_signal(kDegree, 2), second = random_signal(kDegree, 3);
  auto product = multiply.multiply(first, second);
  product[sh::index(kHighest, 5)] += trial.either(0.0f, 0.05f);
  Random random(4);
  double squares = 0;
  const int count = trial.fast ? 50 : 500;
  for (int i = 0; i < count; ++i) {
    const Vec3d direction = uniform_sphere(random_sample(random));
    const double error = value_at(product, kHighest, direction) -
                         value_at(first, kDegree, direction) * value_at(second, kDegree, direction);
    squares += error * error;
  }
  // The L2 norm over the sphere, from values at random directions.
  const double error = std::sqrt(4 * kPi * squares / count);
  return {error / (norm_of(first) * norm_of(second))};
}

/// Two functions of the highest degree: h_00 = Σ f_i g_i / √4π.
StabilityMeasure product_of_two_highest(const StabilityTrial& trial) {
  const ShProduct multiply({kHighest, kHighest, 2});
  const auto first = random_signal(kHighest, 5), second = random_signal(kHighest, 6);
  const auto product = multiply.multiply(first, second);
  double expected = trial.either(0.0, 0.02);
  for (std::size_t i = 0; i < first.size(); ++i) expected += double{first[i]} * double{second[i]};
  expected /= std::sqrt(4 * kPi);
  return {std::abs(product[0] - expected) / (norm_of(first) * norm_of(second))};
}

}  // namespace

std::vector<StabilityCase> harmonics_cases() {
  using enum BoundKind;
  const std::string part = "harmonics";
  return {
      {"poles", part, "error of Y_lm at ±z to degree 64, lengths 1e-100 … 1e100", at_most, 2.5e-12,
       "what sh::evaluate() promises in double", poles},
      {"poles-in-floats", part, "error of Y_lm at ±z to degree 64", at_most, 5.8e-7,
       "what the kernel promises to degree 64", poles_in_floats},
      {"addition-theorem", part, "relative error of Σ Y_lm² of a band, to 1e-16 from a pole",
       at_most, 4e-12, "twice the error of a value, 2.5e-12, over a band's √(2l + 1)/4π",
       addition_theorem},
      {"ringing-sun", part, "least value of a sun under its fitted window, below zero, of the mean",
       at_most, 0.02 + 0.01,
       "the window's limit, 2 % of the mean, and 1 % between the directions that it looks at",
       ringing_sun},
      {"ringing-hann", part, "least value of a sun under a Hann window, below zero, of its peak",
       at_most, 0.027,
       "Σ (2l + 1) w_l P_l, summed in double: −2.62 % of its peak at degree 10, −2.0 % in the "
       "limit",
       ringing_hann},
      {"product-of-two-high", part,
       "L2 error of a product of degrees 32 and 32, to 64, over both norms", at_most, 1e-6,
       "ten times what is promised to degree 10: roundings grow with the grid's side",
       product_of_two_high},
      {"product-of-two-highest", part, "error of h_00 of degrees 64 and 64, over both norms",
       at_most, 1e-6, "as above", product_of_two_highest},
  };
}

}  // namespace rimlight::stability
