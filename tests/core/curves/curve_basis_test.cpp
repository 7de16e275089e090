#include "core/curves/curve_basis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/base/check.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

BrdfCurve random_curve(CurveAxis axis, std::uint64_t seed) {
  Random random(seed);
  BrdfCurve curve{axis, {}};
  for (Vec3f& value : curve.values) {
    for (int c = 0; c < 3; ++c) value[c] = static_cast<float>(std::exp(random.uniform(-9, 9)));
  }
  return curve;
}

TEST(CurveBasis, ACurveComesBackFromItsCoefficients) {
  for (const CurveAxis axis : {CurveAxis::half_angle, CurveAxis::difference_angle}) {
    const CurveBasis basis(axis);
    const BrdfCurve curve = random_curve(axis, 1), back = basis.curve(basis.coefficients(curve));
    for (std::size_t i = 0; i < kCurveBins; ++i) {
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(back.values[i][c], curve.values[i][c], 0.1);
    }
  }
}

TEST(CurveBasis, ProductsOfCurvesAndTransportStay) {
  for (const CurveAxis axis : {CurveAxis::half_angle, CurveAxis::difference_angle}) {
    const CurveBasis basis(axis);
    const BrdfCurve curve = random_curve(axis, 2), transport = random_curve(axis, 3);
    const CurveCoefficients coefficients = basis.coefficients(curve);
    std::vector<float> bins, transformed(3 * kCurveBins);
    Vec3d expected, found;
    for (std::size_t i = 0; i < kCurveBins; ++i) {
      expected += Vec3d(curve.values[i]) * Vec3d(transport.values[i]);
      for (int c = 0; c < 3; ++c) bins.push_back(transport.values[i][c]);
    }
    basis.transform(bins, transformed, 3);
    for (std::size_t k = 0; k < kCurveBins; ++k) {
      for (int c = 0; c < 3; ++c) {
        found[c] += double{coefficients[k][c]} * transformed[3 * k + static_cast<std::size_t>(c)];
      }
    }
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c] / expected[c], 1, 1e-4);
  }
}

TEST(CurveBasis, ConstantAndLinearCurvesOverTheDifferenceAngleHaveTwoCoefficients) {
  const CurveBasis basis(CurveAxis::difference_angle);
  BrdfCurve curve{CurveAxis::difference_angle, {}};
  for (std::size_t i = 0; i < kCurveBins; ++i) {
    curve.values[i] = Vec3f::filled(3 + 0.01f * static_cast<float>(i));
  }
  const CurveCoefficients coefficients = basis.coefficients(curve);
  for (std::size_t k = 2; k < kCurveBins; ++k) EXPECT_NEAR(coefficients[k].x, 0, 1e-4);
  EXPECT_GT(coefficients[0].x, 10);
}

TEST(CurveBasis, RefusesACurveOverTheOtherAngle) {
  const CurveBasis basis(CurveAxis::half_angle);
  EXPECT_THROW(basis.coefficients({CurveAxis::difference_angle, {}}), CheckFailure);
}

}  // namespace
}  // namespace rimlight
