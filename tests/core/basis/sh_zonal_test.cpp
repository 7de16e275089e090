#include "core/basis/sh_zonal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/check.h"
#include "core/basis/sh_rotation.h"
#include "core/math/quadrature.h"
#include "tests/core/basis/sh_cases.h"
#include "tests/support/error_of.h"
#include "tests/support/reference/spherical_harmonics.h"

namespace rimlight {
namespace {

constexpr double kPi = std::numbers::pi;

/// ∫ f Y_l0 over the sphere by composite Gauss–Legendre in the angle, in double: 200 panels.
double projected(const std::function<double(double)>& lobe, int l) {
  double sum = 0;
  for (int panel = 0; panel < 200; ++panel) {
    for (const QuadraturePoint& p : gauss_legendre(8)) {
      const double angle = (panel + 0.5 + 0.5 * p.position) * kPi / 200;
      const double y = reference::spherical_harmonic(l, 0, {std::sin(angle), 0, std::cos(angle)});
      sum += p.weight * kPi / 400 * 2 * kPi * std::sin(angle) * lobe(std::cos(angle)) * y;
    }
  }
  return sum;
}

TEST(ShZonal, TheClampedCosineEqualsItsIntegralsToTheLargestDegree) {
  const auto lobe = sh::clamped_cosine_lobe(sh::kLargestDegree);
  ASSERT_EQ(lobe.size(), 33u);
  for (int l = 0; l <= sh::kLargestDegree; ++l) {
    const double truth = projected([](double t) { return std::max(t, 0.0); }, l);
    EXPECT_NEAR(lobe[static_cast<std::size_t>(l)], truth, 1e-12) << l;
    if (l > 1 && l % 2 == 1) {
      EXPECT_EQ(lobe[static_cast<std::size_t>(l)], 0);
    }
  }
  // As irradiance factors: π, 2π/3, π/4, 0, −π/24 (Ramamoorthi and Hanrahan 2001).
  const double factors[] = {kPi, 2 * kPi / 3, kPi / 4, 0, -kPi / 24};
  for (int l = 0; l < 5; ++l) {
    const double factor = std::sqrt(4 * kPi / (2 * l + 1)) * lobe[static_cast<std::size_t>(l)];
    EXPECT_NEAR(factor, factors[l], 1e-14);
  }
}

TEST(ShZonal, PhongLobesEqualTheirIntegralsAndIntegrateToOne) {
  for (const double exponent : {0.0, 0.5, 1.0, 2.0, 7.3, 50.0, 300.0}) {
    const auto value = [&](double t) {
      return t > 0 ? (exponent + 1) / (2 * kPi) * std::pow(t, exponent) : 0;
    };
    const auto lobe = sh::phong_lobe(exponent, sh::kLargestDegree);
    EXPECT_NEAR(lobe[0] * std::sqrt(4 * kPi), 1, 1e-14) << exponent;
    for (int l = 0; l <= sh::kLargestDegree; ++l) {
      // √t at a panel's edge costs eight points 3e-5 of its h^1.5 · 2/3, h = π/200, times 2π Y_l0.
      const double bound = exponent == 0.5 ? 1e-6 : 1e-10;
      EXPECT_NEAR(lobe[static_cast<std::size_t>(l)], projected(value, l), bound)
          << exponent << " " << l;
    }
  }
}

TEST(ShZonal, VerySharpPhongLobesBecomeADirection) {
  const auto lobe = sh::phong_lobe(1e12, sh::kLargestDegree);
  for (int l = 0; l <= sh::kLargestDegree; ++l) {
    EXPECT_NEAR(lobe[static_cast<std::size_t>(l)], std::sqrt((2 * l + 1) / (4 * kPi)), 1e-8);
  }
  for (const double value : sh::phong_lobe(std::numeric_limits<double>::max(), 32)) {
    EXPECT_TRUE(std::isfinite(value));
  }
}

TEST(ShZonal, SampledLobesAreExactForPolynomialsWithAKinkAtTheHorizon) {
  const auto sampled = sh::sampled_lobe([](double t) { return std::max(t, 0.0); }, 32, 18);
  const auto truth = sh::clamped_cosine_lobe(32);
  for (std::size_t l = 0; l < truth.size(); ++l) EXPECT_NEAR(sampled[l], truth[l], 1e-13) << l;
  const auto narrow = [](double t) { return std::exp(40 * (t - 1)); };
  const auto peak = sh::sampled_lobe(narrow, 20);
  for (int l = 0; l <= 20; ++l) {
    EXPECT_NEAR(peak[static_cast<std::size_t>(l)], projected(narrow, l), 1e-12) << l;
  }
}

TEST(ShZonal, ALobeOfFewBandsIsItsOwnSum) {
  const sh::ZonalLobe lobe = {0.5, -1, 2, 0.25};
  const auto again = sh::sampled_lobe([&](double t) { return sh::lobe_value(lobe, t); }, 5, 8);
  for (std::size_t l = 0; l < 6; ++l) EXPECT_NEAR(again[l], l < 4 ? lobe[l] : 0, 1e-14);
}

TEST(ShZonal, ATurnedLobeHasItsValuesAboutTheNewAxis) {
  Random random(91);
  const auto lobe = sh::phong_lobe(8, 12);
  for (const Vec3d& axis : telling_directions(10)) {
    const auto turned = sh::turned_lobe(lobe, axis * 3.0);
    for (int i = 0; i < 5; ++i) {
      const Vec3d direction = uniform_sphere(random_sample(random));
      EXPECT_NEAR(value_at(turned, direction), sh::lobe_value(lobe, dot(axis, direction)), 1e-12);
    }
  }
}

TEST(ShZonal, TurningALobeIsRotatingItsCoefficients) {
  Random random(92);
  const auto lobe = sh::clamped_cosine_lobe(20);
  std::vector<double> upright(sh::coefficient_count(20), 0.0), rotated_lobe(upright.size());
  for (int l = 0; l <= 20; ++l) upright[sh::index(l, 0)] = lobe[static_cast<std::size_t>(l)];
  for (int i = 0; i < 20; ++i) {
    const Quaternion rotation = random_rotation(random);
    sh::Rotation(rotation, 20).apply(std::span<const double>(upright), rotated_lobe);
    const auto turned = sh::turned_lobe(lobe, rotated(rotation, {0, 0, 1}));
    for (std::size_t c = 0; c < turned.size(); ++c) EXPECT_NEAR(turned[c], rotated_lobe[c], 1e-12);
  }
}

TEST(ShZonal, ConvolutionIsTheIntegralOverTheSphere) {
  constexpr int kDegree = 6;
  Random random(93);
  const auto lobe = sh::phong_lobe(3, kDegree);
  const auto signal = random_signal(kDegree, random);
  std::vector<float> blurred(signal);
  blurred.insert(blurred.end(), signal.begin(), signal.end());  // two signals at once
  sh::convolve(lobe, blurred);
  const std::vector<float> first(blurred.begin(),
                                 blurred.begin() + static_cast<std::ptrdiff_t>(signal.size()));
  EXPECT_TRUE(std::equal(first.begin(), first.end(), blurred.begin() + std::ssize(signal)));
  for (int i = 0; i < 10; ++i) {
    const Vec3d middle = uniform_sphere(random_sample(random));
    const double truth = integrate_sphere(kDegree + 1, [&](const Vec3d& d) {
      return value_at(signal, d) * sh::lobe_value(lobe, dot(d, middle));
    });
    EXPECT_NEAR(value_at(first, middle), truth, 49 * 6e-8);
  }
}

TEST(ShZonal, RefusesBadLobesAndShapes) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_THROW(sh::phong_lobe(-1, 3), CheckFailure);
  EXPECT_THROW(sh::phong_lobe(infinity, 3), CheckFailure);
  EXPECT_THROW(sh::clamped_cosine_lobe(65), CheckFailure);
  EXPECT_THROW(sh::sampled_lobe([](double) { return 1.0; }, 3, 0), CheckFailure);
  EXPECT_THAT(test::error_of([&] { sh::sampled_lobe([&](double) { return infinity; }, 3); }),
              testing::StartsWith("lobe: found inf at cosine"));
  std::vector<float> ten(10);
  EXPECT_THROW(sh::convolve(sh::clamped_cosine_lobe(2), ten), CheckFailure);
  EXPECT_THROW(sh::convolve({}, ten), CheckFailure);
}

}  // namespace
}  // namespace rimlight
