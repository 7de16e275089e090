#include "core/material/brdf_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "core/base/check.h"
#include "core/material/half_difference.h"
#include "core/math/random.h"
#include "core/math/sampling.h"
#include "tests/core/material/brdf_cases.h"
#include "tests/support/reference/brdf.h"

namespace rimlight {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr CurveAxis kAxes[] = {CurveAxis::half_angle, CurveAxis::difference_angle};

double angle_on(CurveAxis axis, const HalfDifference& angles) {
  return axis == CurveAxis::half_angle ? angles.half : angles.difference;
}

FactorSet only(CurveAxis axis) {
  return {axis == CurveAxis::half_angle, axis == CurveAxis::difference_angle};
}

/// A pair of directions near the mirror, within `width`.
DirectionPair near_mirror(Random& random, double width) {
  Vec3d in = uniform_sphere(random_sample(random));
  in.z = std::abs(in.z);
  const Vec3d mirror(-in.x, -in.y, in.z);
  return {in, normalized(mirror + uniform_sphere(random_sample(random)) * width)};
}

bool has_factors(const Brdf& brdf) {
  return factor(brdf, CurveAxis::half_angle, 0) || factor(brdf, CurveAxis::difference_angle, 0);
}

TEST(BrdfCurve, BinsAreTheMerlFilesBins) {
  EXPECT_EQ(bin_begin(CurveAxis::half_angle, 0), 0);
  EXPECT_EQ(bin_begin(CurveAxis::half_angle, 256), kPi / 2);
  EXPECT_DOUBLE_EQ(bin_begin(CurveAxis::half_angle, 128), kPi / 8);
  EXPECT_DOUBLE_EQ(bin_begin(CurveAxis::difference_angle, 64), kPi / 8);
  for (const CurveAxis axis : kAxes) {
    for (std::size_t bin = 0; bin < kCurveBins; ++bin) {
      const double begin = bin_begin(axis, static_cast<double>(bin));
      const double end = bin_begin(axis, static_cast<double>(bin + 1));
      ASSERT_EQ(bin_of(axis, 0.5 * (begin + end)), bin);
      ASSERT_EQ(bin_of(axis, begin + 1e-9 * (end - begin) + 1e-15), bin);
    }
    EXPECT_EQ(bin_of(axis, -1), 0u);
    EXPECT_EQ(bin_of(axis, kPi / 2), 255u);
    EXPECT_EQ(bin_of(axis, 10), 255u);
  }
}

// Against formulas of another form, in double.
TEST(BrdfCurve, FactorTimesQuotientIsTheModel) {
  Random random(31);
  int compared = 0;
  for (const BrdfCase& item : brdf_cases()) {
    for (const CurveAxis axis : kAxes) {
      if (!factor(item.brdf, axis, 0)) continue;
      for (int i = 0; i < 500; ++i) {
        const DirectionPair pair = near_mirror(random, 2 * std::min(0.5, lobe_width(item.brdf)));
        if (pair.in.z < 1e-3 || pair.out.z < 1e-3) continue;
        const HalfDifference angles = half_difference(pair.in, pair.out);
        const Vec3d product = quotient(item.brdf, only(axis), pair.in, pair.out) *
                              *factor(item.brdf, axis, angle_on(axis, angles));
        const Vec3d whole = quotient(item.brdf, {}, pair.in, pair.out);
        for (int c = 0; c < 3; ++c) {
          const double want = reference::specular(item.brdf, c, pair.in, pair.out);
          // Index 1 reflects nothing, up to the square of a rounding error at grazing angles; the
          // reference takes tan² θ_h from 1 − cos², which costs 1e-16 / m².
          const double sharpness = 1 / std::pow(lobe_width(item.brdf), 2);
          const double bound = want * (1e-9 + 1e-14 * sharpness) + 1e-18 * sharpness;
          ASSERT_NEAR(product[c], want, bound) << item.name;
          ASSERT_NEAR(whole[c], product[c], 1e-12 * std::abs(product[c])) << item.name;
          compared += want > 0;
        }
      }
    }
  }
  EXPECT_GT(compared, 20'000);
}

TEST(BrdfCurve, BothFactorsAndTheRestAreTheModel) {
  const Brdf brdf{.model = BrdfModel::cook_torrance, .specular = {1, 0.5f, 1}, .roughness = 0.3f};
  Random random(32);
  for (int i = 0; i < 500; ++i) {
    const DirectionPair pair = near_mirror(random, 0.5);
    const HalfDifference angles = half_difference(pair.in, pair.out);
    const Vec3d product = quotient(brdf, {true, true}, pair.in, pair.out) *
                          *factor(brdf, CurveAxis::half_angle, angles.half) *
                          *factor(brdf, CurveAxis::difference_angle, angles.difference);
    const Vec3d whole = quotient(brdf, {}, pair.in, pair.out);
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(product[c], whole[c], 1e-12 * whole[c]);
  }
}

TEST(BrdfCurve, AgreesWithTheRenderersModel) {
  const Brdf brdf{.model = BrdfModel::cook_torrance,
                  .albedo = {0.2f, 0.1f, 0.3f},
                  .specular = {1, 1, 1},
                  .roughness = 0.3f};
  Random random(33);
  for (int i = 0; i < 500; ++i) {
    const DirectionPair pair = near_mirror(random, 0.5);
    if (pair.in.z < 0.02 || pair.out.z < 0.02) continue;
    const Vec3f want = evaluate(brdf, Vec3f(pair.in), Vec3f(pair.out));
    const Vec3d got = evaluate(CurvedBrdf{brdf, {}, {}}, pair.in, pair.out);
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(got[c], want[c], 2e-4 * want[c] + 1e-6);
  }
}

TEST(BrdfCurve, ItsOwnAveragesAreTheModelUpToABin) {
  const Brdf brdf{.model = BrdfModel::cook_torrance, .albedo = {}, .specular = {1, 1, 1}};
  CurvedBrdf drawn{brdf, factor_curve(brdf, CurveAxis::half_angle),
                   factor_curve(brdf, CurveAxis::difference_angle)};
  Random random(34);
  double worst = 0;
  for (int i = 0; i < 2000; ++i) {
    const DirectionPair pair = near_mirror(random, 0.2);
    if (pair.in.z < 0.1 || pair.out.z < 0.1) continue;
    const double want = quotient(brdf, {}, pair.in, pair.out).x;
    const double peak =
        quotient(brdf, {true}, pair.in, pair.out).x * factor(brdf, CurveAxis::half_angle, 0)->x;
    worst = std::max(worst, std::abs(evaluate(drawn, pair.in, pair.out).x - want) / peak);
  }
  // D falls by at most √(2/e)/m · dθ in a bin of dθ ≈ 0.004 at θ_h = m/√2: half of that, 0.9 %. F
  // changes by at most 5 tan θ_d of its own in a radian, near 84°: half a bin of 0.006 is 15 %, but
  // all is against the peak there, which D seldom reaches.
  EXPECT_LT(worst, 0.04);
  EXPECT_GT(worst, 1e-5);
}

TEST(BrdfCurve, AveragesKeepALobesEnergy) {
  for (const float roughness : {1e-4f, 1e-3f, 0.03f, 0.3f, 1.0f}) {
    const Brdf brdf{.model = BrdfModel::cook_torrance, .roughness = roughness};
    const BrdfCurve curve = *factor_curve(brdf, CurveAxis::half_angle);
    double sum = 0;  // ∫ D cos θ dω, the curve constant in each bin
    for (std::size_t i = 0; i < kCurveBins; ++i) {
      const double begin = bin_begin(curve.axis, static_cast<double>(i));
      const double end = bin_begin(curve.axis, static_cast<double>(i + 1));
      sum += curve.values[i].x * kPi * (std::pow(std::sin(end), 2) - std::pow(std::sin(begin), 2));
    }
    EXPECT_NEAR(sum, 1, roughness < 0.5 ? 1e-4 : 3e-3) << roughness;
  }
}

TEST(BrdfCurve, OnlyModelsOfOneAngleHaveFactors) {
  for (const BrdfCase& item : brdf_cases()) {
    const bool half = factor_curve(item.brdf, CurveAxis::half_angle).has_value();
    const bool difference = factor_curve(item.brdf, CurveAxis::difference_angle).has_value();
    const BrdfModel model = item.brdf.model;
    EXPECT_EQ(half, model == BrdfModel::cook_torrance || model == BrdfModel::blinn_phong);
    EXPECT_EQ(difference,
              model == BrdfModel::cook_torrance || model == BrdfModel::ashikhmin_shirley);
  }
  const Brdf lambert;
  EXPECT_THROW(quotient(lambert, {true}, {0, 0, 1}, {0, 0, 1}), CheckFailure);
}

TEST(BrdfCurve, FresnelFactorMatchesTheFieldAmplitudes) {
  const Brdf gold{
      .model = BrdfModel::cook_torrance, .eta = {0.18f, 100, 1.37f}, .k = {3.42f, 100, 0}};
  for (int degrees = 0; degrees < 90; ++degrees) {
    const double angle = degrees * kPi / 180;
    const Vec3d got = *factor(gold, CurveAxis::difference_angle, angle);
    for (int c = 0; c < 3; ++c) {
      const std::complex<double> index(gold.eta[c], gold.k[c]);
      ASSERT_NEAR(got[c], reference::fresnel(index, std::cos(angle)), 1e-12);
    }
  }
}

TEST(BrdfCurve, ExtremesAreFinite) {
  CurveValues spike{}, large{}, jump{};
  spike[3] = {1e6f, 1e6f, 1e6f};
  for (Vec3f& v : large) v = {1e6f, 1e6f, 1e6f};
  for (std::size_t i = 128; i < kCurveBins; ++i) jump[i] = {1, 1, 1};
  Random random(35);
  for (const BrdfCase& item : brdf_cases()) {
    if (!has_factors(item.brdf)) continue;
    const bool half = factor(item.brdf, CurveAxis::half_angle, 0).has_value();
    const CurveAxis axis = half ? CurveAxis::half_angle : CurveAxis::difference_angle;
    for (const CurveValues& values : {CurveValues{}, spike, large, jump}) {
      CurvedBrdf drawn{item.brdf, {}, {}};
      (half ? drawn.half_angle : drawn.difference_angle) = BrdfCurve{axis, values};
      for (int i = 0; i < 300; ++i) {
        DirectionPair pair = near_mirror(random, 1);
        const double graze = std::pow(10, random.uniform(-12, 0));
        pair.in.z *= graze;
        if (i % 3 == 0) pair.out = {-pair.in.x, -pair.in.y, pair.in.z};
        const Vec3d f = evaluate(drawn, normalized(pair.in), normalized(pair.out));
        ASSERT_TRUE(is_finite(f)) << item.name;
        ASSERT_GE(f.x, 0) << item.name;
        if (values == CurveValues{}) {
          const Vec3f diffuse =
              evaluate_diffuse(item.brdf, Vec3f(normalized(pair.in)), Vec3f(normalized(pair.out)));
          ASSERT_EQ(f, Vec3d(diffuse)) << item.name;
        }
      }
    }
  }
}

TEST(BrdfCurve, CurvesOfEveryParameterAreFinite) {
  for (const float roughness : {1e-4f, 1e-2f, 1.0f}) {
    for (const float n : {1.0f, 1.5f, 100.0f}) {
      for (const float k : {0.0f, 1.0f, 100.0f}) {
        const Brdf brdf{.model = BrdfModel::cook_torrance,
                        .roughness = roughness,
                        .eta = Vec3f::filled(n),
                        .k = Vec3f::filled(k)};
        for (const CurveAxis axis : kAxes) {
          const BrdfCurve curve = *factor_curve(brdf, axis);
          const float most = axis == CurveAxis::difference_angle ? 1 + 1e-6f : 4e7f;
          for (const Vec3f& v : curve.values) {
            ASSERT_TRUE(is_finite(v));
            ASSERT_GE(v.x, 0);
            ASSERT_LE(v.x, most);
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace rimlight
