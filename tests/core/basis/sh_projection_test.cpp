#include "core/basis/sh_projection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>

#include "core/base/check.h"
#include "core/basis/cube_map.h"
#include "core/basis/sh_rotation.h"
#include "tests/core/basis/sh_cases.h"
#include "tests/support/every_target.h"
#include "tests/support/reference/spherical_harmonics.h"

namespace rimlight {
namespace {

std::vector<float> random_values(std::size_t count, Random& random) {
  std::vector<float> values(count);
  for (float& value : values) value = random.uniform_float();
  return values;
}

double norm_of(const std::vector<float>& values) {
  double sum = 0;
  for (const float value : values) sum += static_cast<double>(value) * static_cast<double>(value);
  return std::sqrt(sum);
}

double norm_of_difference(const std::vector<float>& a, const std::vector<float>& b) {
  EXPECT_EQ(a.size(), b.size());
  std::vector<float> difference;
  for (std::size_t i = 0; i < a.size(); ++i) difference.push_back(a[i] - b[i]);
  return norm_of(difference);
}

TEST(ShProjection, EqualsTheSumInDoubleOnEveryTarget) {
  Random random(101);
  struct Case {
    int size, degree;
    std::size_t signals;
  };
  for (const Case& c : {Case{1, 4, 1}, {3, 7, 2}, {6, 20, 3}, {5, 32, 5}, {4, 64, 1}}) {
    const int size = c.size, degree = c.degree;
    const std::size_t signals = c.signals;
    const std::size_t texels = cube::texel_count(size);
    const auto values = random_values(signals * texels, random);
    const std::size_t count = sh::coefficient_count(degree);
    std::vector<double> truth(signals * count, 0.0);
    for (std::size_t t = 0; t < texels; ++t) {
      const auto y = reference::spherical_harmonics(cube::texel_direction(t, size), degree);
      const double weight = cube::texel_solid_angle(t, size);
      for (std::size_t s = 0; s < signals; ++s) {
        const auto value = static_cast<double>(values[s * texels + t]);
        for (std::size_t i = 0; i < count; ++i) truth[s * count + i] += weight * value * y[i];
      }
    }
    test::for_every_target([&] {
      const auto projected = sh::project(sh::cube_quadrature(size), values, degree);
      ASSERT_EQ(projected.size(), truth.size());
      for (std::size_t i = 0; i < truth.size(); ++i) {
        // Weights add up to 4π; a direction's rounding moves Y by l · 3.2 · 6e-8, sums in float of
        // 64 by less.
        ASSERT_NEAR(projected[i], truth[i], 4 * std::numbers::pi * (degree + 4) * 3.2 * 6e-8);
      }
    });
  }
}

TEST(ShProjection, AUniformEnvironmentIsItsMeanAlone) {
  const std::vector<float> values(cube::texel_count(32), 2.0f);
  const auto projected = sh::project(sh::cube_quadrature(32), values, 10);
  EXPECT_NEAR(projected[0], 2 * std::sqrt(4 * std::numbers::pi), 1e-6);
  // The error of midpoints, as the header says: l(l + 1)/(2N²) = 0.054 of √4π · 2, at most.
  for (std::size_t i = 1; i < projected.size(); ++i) {
    const int l = sh::degree_of(i);
    EXPECT_NEAR(projected[i], 0, l * (l + 1) / 2048.0 * 7.1) << i;
  }
}

TEST(ShProjection, TurningTheTexelsIsRotatingTheCoefficients) {
  Random random(102);
  constexpr int kSize = 16, kDegree = 20;
  const auto values = random_values(3 * cube::texel_count(kSize), random);
  const auto upright = sh::project(sh::cube_quadrature(kSize), values, kDegree);
  double worst = 0;
  for (const Quaternion& rotation :
       {axis_angle({1, 0, 0}, std::numbers::pi), axis_angle({0, 1, 0}, 1e-3),
        axis_angle({0, 0, 1}, 0.8), random_rotation(random), random_rotation(random)}) {
    std::vector<float> rotated(upright.size());
    sh::Rotation(rotation, kDegree).apply(upright, rotated);
    const auto turned = sh::project(sh::cube_quadrature(kSize, rotation), values, kDegree);
    worst = std::max(worst, norm_of_difference(rotated, turned) / norm_of(upright));
  }
  std::cout << "worst relative difference " << worst << "\n";
  // Directions rounded to float: 20 · 6e-8 of the basis at each texel, and as chance has it.
  EXPECT_LE(worst, 20 * 6e-8);
  EXPECT_GT(norm_of_difference(
                upright, sh::project(sh::cube_quadrature(kSize, {0, 1, 0, 1}), values, kDegree)),
            0.1);
}

TEST(ShProjection, ProjectingAReconstructionGivesItBack) {
  Random random(103);
  constexpr int kDegree = 6;
  auto signal = random_signal(kDegree, random);
  const auto second = random_signal(kDegree, random);
  signal.insert(signal.end(), second.begin(), second.end());
  const sh::SphereQuadrature quadrature = sh::cube_quadrature(128);
  const auto values = sh::reconstruct(signal, kDegree, quadrature.directions);
  const auto again = sh::project(quadrature, values, kDegree);
  // Products of degree 12 within a texel: 12 · 13/(2 · 128²) = 0.5 %.
  EXPECT_LE(norm_of_difference(again, signal), 0.005 * norm_of(signal));
}

TEST(ShProjection, ReconstructionEqualsTheSumInDoubleOnEveryTarget) {
  Random random(104);
  for (const std::size_t count : {1u, 16u, 17u, 70u, 150u}) {
    for (const int degree : {0, 3, 20, 32}) {
      std::vector<Vec3d> some(count);
      for (Vec3d& d : some) d = Vec3d(Vec3f(uniform_sphere(random_sample(random))));
      const sh::Directions directions(some);
      const std::size_t each = sh::coefficient_count(degree);
      std::vector<std::vector<float>> signals;
      std::vector<float> planar;
      for (int s = 0; s < 4; ++s) {
        signals.push_back(random_signal(degree, random));
        planar.insert(planar.end(), signals.back().begin(), signals.back().end());
      }
      test::for_every_target([&] {
        const auto values = sh::reconstruct(planar, degree, directions);
        ASSERT_EQ(values.size(), 4 * count);
        const auto bands = sh::reconstruct_bands(signals[0], directions);
        ASSERT_EQ(bands.size(), static_cast<std::size_t>(degree + 1) * count);
        // Each of `each` products, at most 2.3, and sums of them, that grow as by chance.
        const double bound = 6e-8 * 2.3 * 4 * static_cast<double>(each);
        for (std::size_t i = 0; i < count; ++i) {
          for (std::size_t s = 0; s < 4; ++s) {
            ASSERT_NEAR(values[s * count + i], value_at(signals[s], some[i]), bound);
          }
          double sum = 0;
          for (std::size_t l = 0; l * count < bands.size(); ++l) {
            sum += static_cast<double>(bands[l * count + i]);
          }
          ASSERT_NEAR(sum, value_at(signals[0], some[i]), bound);
        }
      });
    }
  }
}

TEST(ShProjection, RefusesShapesThatDoNotFit) {
  const sh::SphereQuadrature quadrature = sh::cube_quadrature(2);
  const std::vector<float> values(25);
  EXPECT_THROW(sh::project(quadrature, values, 3), CheckFailure);
  EXPECT_THROW(sh::project(quadrature, std::span(values).first(24), 65), CheckFailure);
  EXPECT_THROW(sh::reconstruct(values, 3, quadrature.directions), CheckFailure);
  EXPECT_THROW(sh::reconstruct_bands(std::span(values).first(24), quadrature.directions),
               CheckFailure);
  EXPECT_THROW(sh::cube_quadrature(0), CheckFailure);
  EXPECT_THROW(sh::cube_quadrature(cube::kLargestSize + 1), CheckFailure);
  EXPECT_TRUE(sh::project(quadrature, {}, 3).empty());
}

}  // namespace
}  // namespace rimlight
