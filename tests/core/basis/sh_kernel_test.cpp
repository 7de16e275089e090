#include "core/basis/sh_kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>

#include "core/base/check.h"
#include "core/basis/sh.h"
#include "tests/core/basis/sh_cases.h"
#include "tests/support/every_target.h"
#include "tests/support/reference/spherical_harmonics.h"

namespace rimlight {
namespace {

/// What sh_kernel.h promises: three roundings to float of a product that is at most √((2l + 1)/4π)
/// = 2.27 at degree 32 and 3.2 at 64.
constexpr double kBound = 4.1e-7, kLightBound = 5.8e-7;

std::vector<std::vector<double>> truth_at(const sh::Directions& directions, int degree) {
  std::vector<std::vector<double>> truth;
  for (std::size_t i = 0; i < directions.count(); ++i) {
    truth.push_back(reference::spherical_harmonics(Vec3d(directions.at(i)), degree));
  }
  return truth;
}

/// The kernel's values, and how far the worst is from `truth`.
double worst_error(const sh::Directions& directions, const std::vector<std::vector<double>>& truth,
                   int degree) {
  const std::size_t stride = sh::padded(directions.count());
  AlignedVector<float> values(sh::coefficient_count(degree) * stride);
  sh::evaluate(directions.all(), degree, values, stride);
  double worst = 0;
  for (std::size_t i = 0; i < directions.count(); ++i) {
    for (std::size_t c = 0; c < sh::coefficient_count(degree); ++c) {
      const double error = std::abs(static_cast<double>(values[c * stride + i]) - truth[i][c]);
      if (!(error <= (degree <= sh::kLargestDegree ? kBound : kLightBound))) {
        ADD_FAILURE() << "coefficient " << c << " of direction " << i << ": error " << error;
        return error;
      }
      worst = std::max(worst, error);
    }
  }
  return worst;
}

TEST(ShKernel, IsWithinItsBoundOfTheDefinitionOnEveryTarget) {
  const sh::Directions directions(telling_directions(300));
  const auto truth = truth_at(directions, sh::kLargestLightDegree);
  for (const int degree : {0, 1, 2, 3, 10, 20, 32, 64}) {
    double worst = 0;
    test::for_every_target(
        [&] { worst = std::max(worst, worst_error(directions, truth, degree)); });
    std::cout << "degree " << degree << ": worst error " << worst << "\n";
  }
}

TEST(ShKernel, TakesDirectionsOfAnyLength) {
  std::vector<Vec3d> scaled;
  Random random(72);
  for (const Vec3d& d : telling_directions(50)) {
    scaled.push_back(d * std::pow(10, random.uniform(-18, 18)));
    scaled.push_back(d * random.uniform(0.99, 1.01));
    // Whole groups that are nearly unit take another path.
    for (std::size_t i = 0; i < sh::kDirectionLanes; ++i) {
      scaled.push_back(d * (1 + std::pow(10, random.uniform(-9, -5))));
    }
  }
  const sh::Directions directions(scaled);
  const auto truth = truth_at(directions, 20);
  test::for_every_target([&] { worst_error(directions, truth, 20); });
}

TEST(ShKernel, EqualsTheDoubleRecurrenceInAllShapes) {
  Random random(73);
  for (const std::size_t count : {1u, 15u, 16u, 17u, 100u}) {
    for (int degree = 0; degree <= 6; ++degree) {
      std::vector<Vec3d> some(count);
      for (Vec3d& d : some) d = uniform_sphere(random_sample(random));
      const sh::Directions directions(some);
      const std::size_t stride = sh::padded(count) + 32;
      AlignedVector<float> values(sh::coefficient_count(degree) * stride, 77.0f);
      sh::evaluate(directions.all(), degree, values, stride);
      for (std::size_t i = 0; i < count; ++i) {
        const auto truth = sh::evaluate(Vec3d(directions.at(i)), degree);
        for (std::size_t c = 0; c < truth.size(); ++c) {
          ASSERT_NEAR(values[c * stride + i], truth[c], kBound);
        }
      }
      for (std::size_t c = 0; c < sh::coefficient_count(degree); ++c) {
        for (std::size_t i = sh::padded(count); i < stride; ++i) {
          ASSERT_EQ(values[c * stride + i], 77.0f) << "written beyond the directions";
        }
      }
    }
  }
}

TEST(ShKernel, ZonalValuesAreTheAxialHarmonics) {
  AlignedVector<float> cosines(1040);
  for (std::size_t i = 0; i < cosines.size(); ++i) {
    cosines[i] = static_cast<float>(std::cos(static_cast<double>(i) * std::numbers::pi / 1039));
  }
  const int degree = sh::kLargestDegree;
  AlignedVector<float> values(33 * cosines.size());
  test::for_every_target([&] {
    sh::evaluate_zonal(cosines, degree, values, cosines.size());
    for (std::size_t i = 0; i < cosines.size(); ++i) {
      for (unsigned l = 0; l <= 32; ++l) {
        const auto p = std::legendre(l, static_cast<long double>(cosines[i]));
        const double truth =
            std::sqrt((2 * l + 1) / (4 * std::numbers::pi)) * static_cast<double>(p);
        ASSERT_NEAR(values[l * cosines.size() + i], truth, kBound);
      }
    }
  });
}

TEST(ShKernel, PartsOfDirectionsArePadded) {
  const std::vector<Vec3d> some(21, Vec3d(1, 0, 0));
  const sh::Directions directions(some);
  EXPECT_EQ(directions.count(), 21u);
  EXPECT_EQ(directions.all().x.size(), 32u);
  const sh::DirectionSpans last = directions.part(16, 64);
  ASSERT_EQ(last.x.size(), 16u);
  EXPECT_EQ(last.x[4], 1);
  EXPECT_EQ(last.x[5], 0);
  EXPECT_EQ(last.z[5], 1);
  EXPECT_EQ(directions.part(0, 16).x.size(), 16u);
  EXPECT_THROW(directions.part(8, 16), CheckFailure);
  EXPECT_THROW(directions.part(48, 16), CheckFailure);
}

TEST(ShKernel, RefusesWrongShapes) {
  const sh::Directions directions(std::vector<Vec3d>(16, Vec3d(0, 0, 1)));
  AlignedVector<float> values(9 * 16);
  EXPECT_NO_THROW(sh::evaluate(directions.all(), 2, values, 16));
  EXPECT_THROW(sh::evaluate(directions.all(), 3, values, 16), CheckFailure);
  EXPECT_THROW(sh::evaluate(directions.all(), 2, values, 8), CheckFailure);
  EXPECT_THROW(sh::evaluate(directions.all(), -1, values, 16), CheckFailure);
  EXPECT_THROW(sh::evaluate(directions.all(), 65, values, 16), CheckFailure);
  const auto x = directions.all().x;
  EXPECT_THROW(sh::evaluate({x, x, x.first(0)}, 2, values, 16), CheckFailure);
  EXPECT_THROW(sh::evaluate_zonal(x.first(8), 8, values, 16), CheckFailure);
}

}  // namespace
}  // namespace rimlight
