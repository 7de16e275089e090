#include "core/basis/sh_window.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/basis/cube_map.h"
#include "core/basis/sh.h"
#include "core/basis/sh_projection.h"

namespace rimlight::sh {
namespace {

constexpr const char* kWhere = "window of a light";

// Of sums in float, over their largest value: a light blurred until nothing is below zero has
// values that cannot be told from it.
constexpr double kRounding = 4e-7;

std::size_t to_size(int value) { return static_cast<std::size_t>(value); }

/// Throws for a light that no window makes positive.
void check_light(std::span<const float> luminance) {
  double largest = 0;
  for (std::size_t i = 0; i < luminance.size(); ++i) {
    if (!std::isfinite(luminance[i])) {
      throw Error(kWhere, "coefficient " + std::to_string(i) + " not finite", "finite ones");
    }
    largest = std::max(largest, std::abs(static_cast<double>(luminance[i])));
  }
  if (largest > 0 && !(luminance[0] > 0)) {
    throw Error(kWhere, "a mean that is not above zero", "a light, which has a positive mean");
  }
}

/// A light's bands, each reconstructed by itself on a dense set of directions.
class BandValues {
 public:
  explicit BandValues(std::span<const float> luminance)
      : degree_(degree_of_count(luminance.size())) {
    const Directions directions = cube_quadrature(4 * (degree_ + 1)).directions;
    count_ = directions.count();
    values_ = reconstruct_bands(luminance, directions);
    sums_.resize(count_);
  }

  int degree() const { return degree_; }

  /// The least and the largest value over the mean, under a window.
  struct Range {
    double least, largest;
  };
  Range range(const std::vector<double>& factors) {
    std::ranges::fill(sums_, 0.0f);
    for (std::size_t l = 0; l < factors.size(); ++l) {
      const auto factor = static_cast<float>(factors[l]);
      const float* const band = values_.data() + l * count_;
      for (std::size_t i = 0; i < count_; ++i) sums_[i] += factor * band[i];
    }
    const auto [least, largest] = std::ranges::minmax(sums_);
    const auto mean = static_cast<double>(values_[0]);  // band 0, the same at every direction
    return {static_cast<double>(least) / mean, static_cast<double>(largest) / mean};
  }

 private:
  int degree_;
  std::size_t count_ = 0;
  std::vector<float> values_;  // [band][direction]
  std::vector<float> sums_;    // [direction]
};

/// The least t under which the light keeps the limit, given that 0 does not.
double mildest_time(BandValues& bands, double share) {
  const auto keeps = [&](double time) {
    const auto [least, largest] = bands.range(diffusion_factors(time, bands.degree()));
    return least >= -share - kRounding * largest;
  };
  // Where band 1 is gone, e^(−2t) below a float's rounding, only the mean is left.
  double too_short = 0, long_enough = 10;
  for (double shorter = 1e-6; shorter < 10; shorter *= 2) {
    if (keeps(shorter)) {
      long_enough = shorter;
      break;
    }
    too_short = shorter;
  }
  while (long_enough - too_short > 1e-3 * long_enough) {
    const double middle = (too_short + long_enough) / 2;
    (keeps(middle) ? long_enough : too_short) = middle;
  }
  return long_enough;
}

}  // namespace

std::vector<double> window_factors(Window window, int degree) {
  check_degree(degree);
  std::vector<double> factors(to_size(degree + 1), 1.0);
  for (int l = 1; l <= degree; ++l) {
    const double x = std::numbers::pi * l / (degree + 1);
    double& factor = factors[to_size(l)];
    if (window == Window::hann) factor = (1 + std::cos(x)) / 2;
    if (window == Window::lanczos) factor = std::sin(x) / x;
  }
  return factors;
}

std::vector<double> diffusion_factors(double time, int degree) {
  check_degree(degree);
  RIMLIGHT_CHECK(time >= 0);
  std::vector<double> factors;
  for (int l = 0; l <= degree; ++l) factors.push_back(l == 0 ? 1 : std::exp(-time * l * (l + 1)));
  return factors;
}

FittedWindow fitted_window(std::span<const float> luminance, const RingingLimit& limit) {
  RIMLIGHT_CHECK(limit.share >= 0);
  RIMLIGHT_CHECK(limit.share <= 1);
  const int degree = degree_of_count(luminance.size());
  check_light(luminance);
  FittedWindow fitted{0, window_factors(Window::none, degree), 0, 0};
  if (luminance[0] == 0) return fitted;
  BandValues bands(luminance);
  fitted.least_before = fitted.least_after = bands.range(fitted.factors).least;
  if (fitted.least_before >= -limit.share) return fitted;
  fitted.time = mildest_time(bands, limit.share);
  fitted.factors = diffusion_factors(fitted.time, degree);
  fitted.least_after = bands.range(fitted.factors).least;
  return fitted;
}

}  // namespace rimlight::sh
