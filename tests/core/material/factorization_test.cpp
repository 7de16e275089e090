#include "core/material/factorization.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/error.h"
#include "core/material/albedo.h"
#include "core/math/random.h"
#include "core/math/sampling.h"

namespace rimlight {
namespace {

constexpr double kPi = std::numbers::pi;

class FunctionBrdf : public MeasuredBrdf {
 public:
  using Function = std::optional<Vec3d> (*)(const HalfDifference&, const DirectionPair&);
  explicit FunctionBrdf(Function function) : function_(function) {}

 private:
  std::optional<Vec3d> value(const HalfDifference& angles,
                             const DirectionPair& pair) const override {
    return function_(angles, pair);
  }
  Function function_;
};

double half_factor(double angle) { return 0.05 + 8 * std::exp(-std::pow(angle / 0.15, 2)); }
double difference_factor(double angle) { return 0.1 + std::pow(1 - std::cos(angle), 3); }
double rest_factor(double cosine) { return 1 / (0.5 + cosine); }

std::optional<Vec3d> separable(const HalfDifference& angles, const DirectionPair& pair) {
  const double grey = half_factor(angles.half) * difference_factor(angles.difference) *
                      rest_factor(pair.in.z) * rest_factor(pair.out.z);
  return Vec3d(grey, 0.5 * grey, grey * half_factor(angles.half));
}

TEST(Factorization, FindsTheFactorsOfAProduct) {
  const FactoredBrdf fit = factorize(FunctionBrdf(separable), "f");
  EXPECT_EQ(fit.valid_share, 1);
  for (int c = 0; c < 3; ++c) {
    EXPECT_LT(fit.error.logarithmic[c], 0.02);
    EXPECT_LT(fit.error.relative[c], 0.02);
    EXPECT_GT(fit.error.logarithmic[c], 0);
  }
  // Each factor up to a constant.
  for (std::size_t i = 0; i < kCurveBins; i += 5) {
    const double half = bin_begin(CurveAxis::half_angle, static_cast<double>(i) + 0.5);
    const double difference = bin_begin(CurveAxis::difference_angle, static_cast<double>(i) + 0.5);
    const double h0 = half_factor(bin_begin(CurveAxis::half_angle, 0.5));
    EXPECT_NEAR(fit.half_angle.values[i].y / fit.half_angle.values[0].y, half_factor(half) / h0,
                i < 240 ? 0.03 * half_factor(half) / h0 : 0.1)
        << i;
    if (i > 240) continue;  // few pairs above the horizon are so far apart
    EXPECT_NEAR(fit.difference_angle.values[i].x / fit.difference_angle.values[100].x,
                difference_factor(difference) / difference_factor(kPi / 2 * 100.5 / 256),
                0.05 * difference_factor(difference) / difference_factor(kPi / 2 * 100.5 / 256))
        << i;
  }
}

TEST(Factorization, IsTheProductOfItsFactors) {
  FactoredBrdf fit = factorize(FunctionBrdf(separable), "f");
  Random random(71);
  for (int i = 0; i < 200; ++i) {
    const Vec3d in = cosine_hemisphere(random_sample(random));
    const Vec3d out = cosine_hemisphere(random_sample(random));
    const HalfDifference angles = half_difference(in, out);
    const Vec3d product =
        rest_at(fit, in, out) *
        Vec3d(fit.half_angle.values[bin_of(CurveAxis::half_angle, angles.half)]) *
        Vec3d(fit.difference_angle.values[bin_of(CurveAxis::difference_angle, angles.difference)]);
    EXPECT_EQ(evaluate(fit, in, out), product);
    EXPECT_EQ(evaluate(fit, in, out), evaluate(fit, out, in));
  }
  EXPECT_EQ(evaluate(fit, {0, 0, 1}, {0, 1, 0}), Vec3d());
  for (Vec3f& v : fit.half_angle.values) v = {};
  EXPECT_EQ(evaluate(fit, {0, 0, 1}, {0, 0, 1}), Vec3d());
}

TEST(Factorization, ShowsTheErrorOfWhatIsNoProduct) {
  const auto crossed = [](const HalfDifference& angles,
                          const DirectionPair&) -> std::optional<Vec3d> {
    // No product: the lobe widens with θ_d, and depends on φ_d.
    const double width = 0.1 + 0.4 * angles.difference + 0.1 * std::cos(2 * angles.azimuth);
    return Vec3d::filled(0.02 + std::exp(-std::pow(angles.half / width, 2)));
  };
  const FactoredBrdf fit = factorize(FunctionBrdf(crossed), "f");
  EXPECT_GT(fit.error.logarithmic.x, 0.1);
  EXPECT_LT(fit.error.logarithmic.x, 1);
  EXPECT_GT(fit.error.relative.x, 0.05);
  EXPECT_LT(fit.error.relative.x, 1);
}

TEST(Factorization, BinsWithoutASampleFollowTheirNeighbours) {
  const auto with_gaps = [](const HalfDifference& angles,
                            const DirectionPair& pair) -> std::optional<Vec3d> {
    const std::size_t half = bin_of(CurveAxis::half_angle, angles.half);
    const std::size_t difference = bin_of(CurveAxis::difference_angle, angles.difference);
    if ((half >= 100 && half < 110) || half > 230 || difference < 20) return std::nullopt;
    return separable(angles, pair);
  };
  const FactoredBrdf fit = factorize(FunctionBrdf(with_gaps), "f");
  EXPECT_LT(fit.valid_share, 0.9);
  const float before = fit.half_angle.values[99].x, after = fit.half_angle.values[110].x;
  for (std::size_t i = 100; i < 110; ++i) {
    EXPECT_LT(fit.half_angle.values[i].x, before * 1.02f);
    EXPECT_GT(fit.half_angle.values[i].x, after * 0.98f);
  }
  for (const BrdfCurve& curve : {fit.half_angle, fit.difference_angle}) {
    for (const Vec3f& v : curve.values) {
      EXPECT_TRUE(is_finite(v));
      EXPECT_GT(v.x, 0);
      EXPECT_LE(v.x, 1e6f);
    }
  }
}

TEST(Factorization, ZeroAndHugeValuesStayFinite) {
  const auto wild = [](const HalfDifference& angles, const DirectionPair&) -> std::optional<Vec3d> {
    return Vec3d(0, angles.half < 0.3 ? 1e6 : 0, 1e30);
  };
  const FactoredBrdf fit = factorize(FunctionBrdf(wild), "f");
  for (std::size_t i = 0; i < kCurveBins; ++i) {
    ASSERT_TRUE(is_finite(fit.half_angle.values[i])) << i;
    ASSERT_TRUE(is_finite(fit.difference_angle.values[i])) << i;
  }
  for (const Vec3f& v : fit.rest) ASSERT_TRUE(is_finite(v));
  EXPECT_TRUE(is_finite(fit.error.logarithmic));
  EXPECT_TRUE(is_finite(fit.error.relative));
}

TEST(Factorization, WithoutAnySampleIsAnError) {
  const auto none = [](const HalfDifference&, const DirectionPair&) -> std::optional<Vec3d> {
    return std::nullopt;
  };
  EXPECT_THROW(factorize(FunctionBrdf(none), "f"), Error);
}

}  // namespace
}  // namespace rimlight
