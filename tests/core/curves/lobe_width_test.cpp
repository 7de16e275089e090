#include "core/curves/lobe_width.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rimlight {
namespace {

Brdf beckmann(double roughness) {
  Brdf brdf;
  brdf.model = BrdfModel::cook_torrance;
  brdf.roughness = static_cast<float>(roughness);
  return brdf;
}

TEST(LobeWidth, TheMedianOfBeckmannsLobeIsInClosedForm) {
  // ∫ D cos dω up to θ is 1 − exp(−tan²θ / m²).
  for (const double roughness : {1e-3, 0.02, 0.1, 0.5, 1.0}) {
    const auto curve = factor_curve(beckmann(roughness), CurveAxis::half_angle);
    const double expected = std::atan(roughness * std::sqrt(std::log(2.0)));
    EXPECT_NEAR(*median_half_angle(*curve), expected, 0.02 * expected) << roughness;
  }
}

TEST(LobeWidth, AConstantCurveHasItsMedianAtFortyFiveDegrees) {
  BrdfCurve curve{CurveAxis::half_angle, {}};
  curve.values.fill({0.2f, 0.3f, 7});
  EXPECT_NEAR(*median_half_angle(curve), std::atan(1.0), 1e-3);
}

TEST(LobeWidth, OfOneBinItLiesInIt) {
  for (const std::size_t bin : {0u, 1u, 100u, 255u}) {
    BrdfCurve curve{CurveAxis::half_angle, {}};
    curve.values[bin] = {0, 1e6f, 0};
    EXPECT_EQ(bin_of(curve.axis, *median_half_angle(curve)), bin);
  }
}

TEST(LobeWidth, ABlackCurveHasNoneAndIsNotTooFine) {
  const BrdfCurve black{CurveAxis::half_angle, {}};
  EXPECT_FALSE(median_half_angle(black).has_value());
  EXPECT_FALSE(is_finer_than_texels(black, 8));
}

TEST(LobeWidth, FinerTexelsResolveSharperLobes) {
  const auto sharp = *factor_curve(beckmann(0.01), CurveAxis::half_angle);
  EXPECT_TRUE(is_finer_than_texels(sharp, 32));
  EXPECT_FALSE(is_finer_than_texels(sharp, 128));
  EXPECT_FALSE(is_finer_than_texels(*factor_curve(beckmann(0.15), CurveAxis::half_angle), 32));
}

}  // namespace
}  // namespace rimlight
