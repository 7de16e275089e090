// sh::fit() of sh_projection.h.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/check.h"
#include "core/basis/sh_projection.h"
#include "core/math/quadrature.h"
#include "tests/core/basis/sh_cases.h"
#include "tests/support/error_of.h"

namespace rimlight {
namespace {

std::vector<Vec3d> random_directions(std::size_t count, Random& random) {
  std::vector<Vec3d> directions(count);
  for (Vec3d& d : directions) d = uniform_sphere(random_sample(random));
  return directions;
}

TEST(ShFit, FindsTheSignalsThatTheValuesAreOf) {
  Random random(111);
  for (const int degree : {0, 1, 5, 10}) {
    const std::size_t count = sh::coefficient_count(degree);
    auto directions = random_directions(4 * count, random);
    const auto first = random_signal(degree, random), second = random_signal(degree, random);
    std::vector<float> values;
    for (const auto& signal : {first, second}) {
      for (const Vec3d& d : directions) values.push_back(static_cast<float>(value_at(signal, d)));
    }
    for (Vec3d& d : directions) d *= random.uniform(0.5, 2);  // of any length
    const sh::Fit fit = sh::fit(directions, values, degree);
    ASSERT_EQ(fit.coefficients.size(), 2 * count);
    EXPECT_GE(fit.condition, 1 - 1e-12);
    // Values rounded to float, 2⁻²⁴ · 2.3 · count at the worst, over the least singular value, that
    // is √(4 count/4π)/condition or more.
    const double bound = 6e-8 * 2.3 * static_cast<double>(count) * fit.condition + 6e-8;
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_NEAR(fit.coefficients[i], first[i], bound);
      EXPECT_NEAR(fit.coefficients[count + i], second[i], bound);
    }
  }
}

TEST(ShFit, LeavesAResidualThatTheBasisDoesNotSee) {
  // The normal equations: the residual is orthogonal to each Y_lm over the directions.
  Random random(112);
  constexpr int kDegree = 4;
  const auto directions = random_directions(200, random);
  std::vector<float> values(directions.size());
  for (float& value : values) value = random.uniform_float();
  const sh::Fit fit = sh::fit(directions, values, kDegree);
  std::vector<double> seen(fit.coefficients.size(), 0.0);
  double residual_norm = 0;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const double residual =
        static_cast<double>(values[i]) - value_at(fit.coefficients, directions[i]);
    residual_norm += residual * residual;
    const auto y = sh::evaluate(directions[i], kDegree);
    for (std::size_t c = 0; c < y.size(); ++c) seen[c] += residual * y[c];
  }
  EXPECT_GT(residual_norm, 1);
  for (const double value : seen) EXPECT_NEAR(value, 0, 200 * 25 * 6e-8);
}

TEST(ShFit, TheConditionIsThatOfTheGramMatrix) {
  // On Gauss–Legendre points times equal steps, weights near equal in the middle: for band 0 and 1
  // at the six axes the columns are orthogonal, of norms √(6/4π) and √(2 · 3/4π): condition 1.
  const std::vector<Vec3d> axes = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                   {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
  const std::vector<float> values(6, 1.0f);
  EXPECT_NEAR(sh::fit(axes, values, 1).condition, 1, 1e-12);
  // The two along z a hundred times more: √(2 · 102/4π · …) by hand: columns stay orthogonal but
  // for Y_00; z's norm is √(200 · 3/4π), x's and y's √(2 · 3/4π), Y_00's √(204/4π).
  std::vector<Vec3d> many(axes);
  for (int i = 1; i < 100; ++i) many.insert(many.end(), axes.begin() + 4, axes.end());
  const std::vector<float> more(many.size(), 1.0f);
  EXPECT_NEAR(sh::fit(many, more, 1).condition, 10, 1e-10);
}

TEST(ShFit, RefusesDirectionsThatDoNotTellCoefficientsApart) {
  Random random(113);
  // On the equator alone every Y_lm with odd l − m is zero: 3 of 4 … of degree 2, 6 of 9 are left,
  // of which Y_00, Y_20 are the same.
  std::vector<Vec3d> equator;
  for (int i = 0; i < 40; ++i) equator.emplace_back(std::cos(i), std::sin(i), 0);
  const std::vector<float> values(40, 1.0f);
  EXPECT_EQ(test::error_of([&] { sh::fit(equator, values, 2); }),
            "fit of spherical harmonics: found rank 5 from 40 directions, expected rank 9: "
            "directions that tell all coefficients apart");
  const auto few = random_directions(8, random);
  EXPECT_EQ(test::error_of([&] { sh::fit(few, std::span(values).first(8), 2); }),
            "fit of spherical harmonics: found 8 directions, expected at least one for each of 9 "
            "coefficients");
  const std::vector<Vec3d> same(40, Vec3d(0, 0.6, 0.8));
  EXPECT_THAT(test::error_of([&] { sh::fit(same, values, 1); }),
              testing::HasSubstr("found rank 1 from 40 directions"));
}

TEST(ShFit, RefusesNumbersThatAreNone) {
  Random random(114);
  auto directions = random_directions(20, random);
  std::vector<float> values(20, 1.0f);
  values[7] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(test::error_of([&] { sh::fit(directions, values, 1); }),
              testing::HasSubstr("value 7 not finite"));
  values[7] = 1;
  for (const Vec3d& bad :
       {Vec3d(0, 0, 0), Vec3d(std::numeric_limits<double>::infinity(), 0, 0), Vec3d(1e200, 0, 0)}) {
    directions[3] = bad;
    EXPECT_THAT(test::error_of([&] { sh::fit(directions, values, 1); }),
                testing::HasSubstr("direction 3 zero, too long or not finite"));
  }
  EXPECT_THROW(sh::fit(directions, values, sh::kLargestDegree + 1), CheckFailure);
  const std::vector<Vec3d> many(130000, Vec3d(1, 0, 0));
  const std::vector<float> zeros(many.size());
  EXPECT_THAT(test::error_of([&] { sh::fit(many, zeros, 32); }),
              testing::HasSubstr("130000 directions for 1089 coefficients"));
}

}  // namespace
}  // namespace rimlight
