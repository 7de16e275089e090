#include "core/basis/sh_window.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/check.h"
#include "core/basis/sh_zonal.h"
#include "tests/core/basis/sh_cases.h"
#include "tests/support/error_of.h"

namespace rimlight {
namespace {

/// A sun of one direction over a dim sky.
std::vector<float> sun(int degree, const Vec3d& direction, double sky = 0) {
  const auto basis = sh::evaluate(direction, degree);
  std::vector<float> light(basis.size());
  for (std::size_t i = 0; i < basis.size(); ++i) light[i] = static_cast<float>(basis[i]);
  light[0] += static_cast<float>(sky * std::sqrt(4 * std::numbers::pi));
  return light;
}

/// A lit cap of a radius.
std::vector<float> cap(int degree, double cosine, const Vec3d& axis) {
  const auto lobe = sh::sampled_lobe([&](double t) { return t > cosine ? 1.0 : 0.0; }, degree, 400);
  const auto turned = sh::turned_lobe(lobe, axis);
  return {turned.begin(), turned.end()};
}

/// The least value over the mean on directions that the product does not know.
double least_over_mean(std::vector<float> light, const std::vector<double>& factors) {
  sh::scale_bands(factors, light);
  Random random(121);
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 20000; ++i) {
    least = std::min(least, value_at(light, uniform_sphere(random_sample(random))));
  }
  return least * std::sqrt(4 * std::numbers::pi) / static_cast<double>(light[0]);
}

TEST(ShWindow, FactorsStartAtOneAndFall) {
  for (const int degree : {0, 1, 10, sh::kLargestDegree}) {
    for (const sh::Window window : {sh::Window::none, sh::Window::hann, sh::Window::lanczos}) {
      const auto factors = sh::window_factors(window, degree);
      ASSERT_EQ(factors.size(), static_cast<std::size_t>(degree) + 1);
      EXPECT_EQ(factors[0], 1);
      EXPECT_TRUE(std::ranges::is_sorted(factors, std::greater{}));
      EXPECT_GT(factors.back(), 0) << "no band asked for is thrown away";
    }
    EXPECT_TRUE(std::ranges::is_sorted(sh::diffusion_factors(0.01, degree), std::greater{}));
  }
}

TEST(ShWindow, FactorsAreTheirFormulas) {
  const auto hann = sh::window_factors(sh::Window::hann, 3);
  const auto lanczos = sh::window_factors(sh::Window::lanczos, 3);
  const double s = std::numbers::sqrt2 / 2, pi = std::numbers::pi;
  const double hann_truth[] = {1, (1 + s) / 2, 0.5, (1 - s) / 2};
  const double lanczos_truth[] = {1, s / (pi / 4), 1 / (pi / 2), s / (3 * pi / 4)};
  for (std::size_t l = 0; l < 4; ++l) {
    EXPECT_NEAR(hann[l], hann_truth[l], 1e-15);
    EXPECT_NEAR(lanczos[l], lanczos_truth[l], 1e-15);
  }
  EXPECT_EQ(sh::window_factors(sh::Window::none, 3), std::vector<double>(4, 1.0));
  EXPECT_NEAR(sh::diffusion_factors(0.1, 2)[2], std::exp(-0.6), 1e-15);
}

TEST(ShWindow, DiffusionNeverLowersTheLeastValue) {
  Random random(122);
  for (int trial = 0; trial < 5; ++trial) {
    auto light = random_signal(8, random);
    light[0] = 3;
    double before = -std::numeric_limits<double>::infinity();
    for (const double time : {0.0, 0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0}) {
      const double least = least_over_mean(light, sh::diffusion_factors(time, 8));
      EXPECT_GE(least, before - 0.01) << time;  // both are found on random directions
      before = least;
    }
  }
}

TEST(ShWindow, TheFittedOneKeepsTheLimitAndNoMilderOneDoes) {
  Random random(123);
  for (const int degree : {3, 10, 20}) {
    for (const double share : {0.0, 0.02, 0.2}) {
      const Vec3d axis = uniform_sphere(random_sample(random));
      for (const auto& light :
           {sun(degree, axis), sun(degree, axis, 0.05), cap(degree, 0.8, axis)}) {
        const sh::FittedWindow fitted = sh::fitted_window(light, {share});
        EXPECT_GE(fitted.least_after, -share - 441 * 4e-7) << "but for rounding of the largest";
        EXPECT_NEAR(fitted.least_before,
                    least_over_mean(light, sh::window_factors(sh::Window::none, degree)),
                    0.02 * std::abs(fitted.least_before) + 0.02);
        // Between the directions that were looked at it may be a little lower.
        EXPECT_GE(least_over_mean(light, fitted.factors), -share - 0.02);
        if (fitted.least_before >= -share) {
          EXPECT_EQ(fitted.time, 0);
          continue;
        }
        EXPECT_GT(fitted.time, 0);
        EXPECT_NEAR(fitted.least_after, -share, 0.01) << "no stronger than it must be";
        const auto milder = sh::diffusion_factors(0.7 * fitted.time, degree);
        EXPECT_LT(least_over_mean(light, milder), -share);
      }
    }
  }
}

TEST(ShWindow, ALightThatDoesNotRingIsLeftAlone) {
  for (const auto& light : {sun(10, {0, 0, 1}, 100), cap(0, 0.5, {0, 1, 0})}) {
    const sh::FittedWindow fitted = sh::fitted_window(light);
    EXPECT_EQ(fitted.time, 0);
    EXPECT_EQ(fitted.least_after, fitted.least_before);
    for (const double factor : fitted.factors) EXPECT_EQ(factor, 1);
  }
}

TEST(ShWindow, ScaleAndDirectionOfTheLightDoNotMatter) {
  const auto light = sun(10, {0, 0, 1}, 0.01);
  const double time = sh::fitted_window(light).time;
  EXPECT_GT(time, 0);
  auto bright = light;
  for (float& value : bright) value *= 1e20f;
  EXPECT_NEAR(sh::fitted_window(bright).time, time, 0.01 * time);
  // Where its least value falls among the directions looked at changes a little.
  EXPECT_NEAR(sh::fitted_window(sun(10, {0.36, 0.48, 0.8}, 0.01)).time, time, 0.15 * time);
}

TEST(ShWindow, BlackIsAllowedAndOthersWithoutAMeanAreRefused) {
  const std::vector<float> black(25, 0.0f);
  EXPECT_EQ(sh::fitted_window(black).time, 0);
  auto light = sun(4, {1, 0, 0});
  light[0] = 0;
  EXPECT_THAT(test::error_of([&] { sh::fitted_window(light); }),
              testing::StartsWith("window of a light: found a mean that is not above zero"));
  light[0] = -1;
  EXPECT_NE(test::error_of([&] { sh::fitted_window(light); }), "no error");
  light[0] = std::numeric_limits<float>::infinity();
  EXPECT_THAT(test::error_of([&] { sh::fitted_window(light); }),
              testing::HasSubstr("coefficient 0 not finite"));
  light[0] = 1;
  EXPECT_THROW(sh::fitted_window(light, {-0.1}), CheckFailure);
  EXPECT_THROW(sh::fitted_window(light, {1.1}), CheckFailure);
  EXPECT_THROW(sh::fitted_window(std::span(light).first(24)), CheckFailure);
  EXPECT_THROW(sh::diffusion_factors(-1, 3), CheckFailure);
}

}  // namespace
}  // namespace rimlight
