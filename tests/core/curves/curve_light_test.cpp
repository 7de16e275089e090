#include "core/curves/curve_light.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/bake/texel_quadrature.h"
#include "core/base/check.h"
#include "tests/core/curves/curve_cases.h"

namespace rimlight {
namespace {

constexpr int kSize = 16;

/// ∫ L dω
Vec3d energy(const LightPoints& points, const PointRadiance& light) {
  Vec3d sum;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (const auto& quarter : points.quarters) {
      for (std::size_t c = 0; c < 3; ++c) {
        sum[static_cast<int>(c)] += double{light.radiance[c][i]} * quarter.solid_angle[i];
      }
    }
  }
  return sum;
}

TEST(CurveSky, PointsAreTheQuartersThatBakesSumOver) {
  const CurveSky sky(kSize);
  const TexelQuadrature texels(kSize);
  ASSERT_EQ(sky.texel_of_point().size(), texels.count());
  for (std::size_t i = 0; i < texels.count(); ++i) {
    const std::size_t texel = sky.texel_of_point()[i];
    EXPECT_EQ(sky.point_of_texel()[texel], i);
    for (std::size_t q = 0; q < kQuarters; ++q) {
      const QuadraturePoint& expected = texels.quarters(texel)[q];
      const auto& found = sky.texels().quarters[q];
      EXPECT_EQ(Vec3f(found.x[i], found.y[i], found.z[i]), expected.direction);
      EXPECT_EQ(found.solid_angle[i], expected.solid_angle);
    }
  }
}

TEST(CurveSky, ConesHoldTheirPoints) {
  const CurveSky sky(kSize);
  for (const LightPoints* points : {&sky.texels(), &sky.coarse()}) {
    for (std::size_t i = 0; i < points->size(); ++i) {
      const LightPoints::Cone& cone = points->cones[i / LightPoints::kVector];
      const double cosine = std::sqrt(1 - double{cone.sine} * cone.sine);
      for (const auto& quarter : points->quarters) {
        if (quarter.solid_angle[i] == 0 || cone.sine == 1) continue;
        EXPECT_GE(cone.x * quarter.x[i] + cone.y * quarter.y[i] + cone.z * quarter.z[i], cosine);
      }
    }
  }
}

TEST(CurveLight, MeansAndStrongestTexelsHoldAllLight) {
  const CurveSky sky(kSize);
  const CubeLight light = random_light(kSize, 4);
  const Vec3d all = integral(light);
  for (const std::size_t strongest :
       {std::size_t{0}, std::size_t{1}, std::size_t{37}, light.count()}) {
    const CurveLight found(sky, light, strongest);
    const Vec3d exact = energy(sky.texels(), found.texels());
    const Vec3d parts =
        energy(sky.coarse(), found.coarse()) + energy(found.strongest_points(), found.strongest());
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(exact[c], all[c], 1e-5 * all[c]);
      EXPECT_NEAR(parts[c], all[c], 1e-4 * all[c]);  // coarse quarters are not just as large
    }
    EXPECT_EQ(found.strongest_indices().size(), strongest);
  }
}

TEST(CurveLight, TheStrongestTexelIsTheBrightest) {
  const CurveSky sky(kSize);
  CubeLight light = random_light(kSize, 4);
  light.channel(1)[777] = 1e5f;
  const CurveLight found(sky, light, 1);
  ASSERT_EQ(found.strongest_indices().size(), 1u);
  EXPECT_EQ(sky.texel_of_point()[found.strongest_indices()[0]], 777u);
  EXPECT_EQ(found.strongest().radiance[1][0], 1e5f);
  for (const float value : found.coarse().radiance[1]) EXPECT_LT(value, 1e4f);
}

TEST(CurveLight, RefusesOtherSizesAndWhatIsNotFinite) {
  EXPECT_THROW(CurveSky(12), CheckFailure);
  const CurveSky sky(kSize);
  EXPECT_THROW(CurveLight(sky, CubeLight(8), 0), CheckFailure);
  CubeLight light(kSize);
  EXPECT_THROW(CurveLight(sky, light, light.count() + 1), CheckFailure);
  light.values[5] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(CurveLight(sky, light, 0), CheckFailure);
}

}  // namespace
}  // namespace rimlight
