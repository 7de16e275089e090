#include "core/material/albedo.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/check.h"
#include "tests/support/reference/brdf.h"

namespace rimlight {
namespace {

CurvedBrdf cook_torrance(float roughness) {
  const Brdf brdf{.model = BrdfModel::cook_torrance,
                  .albedo = {0.5f, 0.5f, 0.5f},
                  .specular = {1, 1, 1},
                  .roughness = roughness};
  return {brdf, factor_curve(brdf, CurveAxis::half_angle),
          factor_curve(brdf, CurveAxis::difference_angle)};
}

TEST(Albedo, OfALambertSurfaceIsItsOwn) {
  const Brdf lambert{.albedo = {0.8f, 0.3f, 0.05f}};
  for (const DirectionalAlbedo& at : directional_albedos(CurvedBrdf{lambert, {}, {}})) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(at.albedo[c], lambert.albedo[c], 1e-6);
  }
  // As a lobe, over half vectors, the horizon cuts cells in two.
  const auto whole = directional_albedos(
      [](const Vec3d&, const Vec3d&) { return Vec3d::filled(std::numbers::inv_pi); });
  for (const DirectionalAlbedo& at : whole) EXPECT_NEAR(at.albedo.x, 1, 5e-3) << at.cosine;
}

TEST(Albedo, OfALobeAgreesWithTheReferenceDownToTheNarrowest) {
  for (const float roughness : {1e-3f, 0.02f, 0.1f, 0.3f, 1.0f}) {
    CurvedBrdf brdf = cook_torrance(roughness);
    brdf.base.albedo = {};
    brdf.half_angle.reset();
    brdf.difference_angle.reset();
    for (const DirectionalAlbedo& at : directional_albedos(brdf)) {
      const Vec3d out{std::sqrt(1 - at.cosine * at.cosine), 0, at.cosine};
      const double want = reference::specular_albedo(brdf.base, 0, out, 120);
      EXPECT_NEAR(at.albedo.x, want, 0.02 * want + 1e-3) << roughness << " at " << at.cosine;
    }
  }
}

TEST(Albedo, AModelsOwnCurvesReflectAtMostWhatTheyGet) {
  for (const float roughness : {1e-4f, 1e-3f, 0.05f, 0.3f, 1.0f}) {
    const double largest = largest_albedo(directional_albedos(cook_torrance(roughness)));
    EXPECT_LE(largest, 1.01) << roughness;
    EXPECT_GT(largest, 0.3) << roughness;
  }
}

TEST(Albedo, DrawnCurvesAboveOneAreFound) {
  for (const float roughness : {1e-3f, 0.2f}) {
    CurvedBrdf brdf = cook_torrance(roughness);
    for (Vec3f& v : brdf.difference_angle->values) v = {1, 1, 30};  // Fresnel's share is 0.04
    EXPECT_GT(largest_albedo(directional_albedos(brdf)), 1.01) << roughness;
    for (Vec3f& v : brdf.half_angle->values) v = {};
    EXPECT_LE(largest_albedo(directional_albedos(brdf)), 0.51) << roughness;
  }
  CurvedBrdf spike = cook_torrance(0.2f);
  spike.half_angle->values = {};
  spike.half_angle->values[100] = {1e6f, 0, 0};
  const double largest = largest_albedo(directional_albedos(spike));
  EXPECT_GT(largest, 10);
  EXPECT_TRUE(std::isfinite(largest));
}

TEST(Albedo, RefusesAnisotropicMaterials) {
  const Brdf ward{.model = BrdfModel::ward, .roughness = 0.1f, .roughness_across = 0.2f};
  EXPECT_THROW(directional_albedos(CurvedBrdf{ward, {}, {}}), CheckFailure);
}

}  // namespace
}  // namespace rimlight
