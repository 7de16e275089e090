#include "core/bake/texel_quadrature.h"

#include <gtest/gtest.h>

#include <numbers>

#include "core/math/random.h"

namespace rimlight {
namespace {

TEST(TexelQuadrature, QuartersLieInTheirTexelAndSumToItsSolidAngle) {
  for (const int size : {1, 3, 8}) {
    const TexelQuadrature texels(size);
    ASSERT_EQ(texels.count(), cube::texel_count(size));
    double sum = 0;
    for (std::size_t texel = 0; texel < texels.count(); ++texel) {
      double angle = 0;
      for (const QuadraturePoint& point : texels.quarters(texel)) {
        EXPECT_EQ(cube::texel_of(Vec3d(point.direction), size), texel);
        EXPECT_NEAR(length(point.direction), 1, 1e-6);
        angle += static_cast<double>(point.solid_angle);
      }
      EXPECT_NEAR(angle / cube::texel_solid_angle(texel, size), 1, 1e-6);
      sum += angle;
    }
    EXPECT_NEAR(sum, 4 * std::numbers::pi, 1e-5);
  }
}

TEST(TexelQuadrature, APatchIsItsPartOfTheFace) {
  Random random(1);
  for (const int size : {1, 5, 16}) {
    const TexelQuadrature texels(size);
    for (std::size_t texel = 0; texel < texels.count(); ++texel) {
      const TexelPatch patch = texels.patch(texel);
      EXPECT_EQ(patch.texel, texel);
      EXPECT_EQ(patch.quarters, &texels.quarters(texel));
      const auto side = static_cast<std::size_t>(size);
      const double u = random.uniform(), v = random.uniform();
      const Vec3d expected =
          cube::direction({static_cast<int>(texel / (side * side)),
                           2 * (static_cast<double>(texel % side) + u) / size - 1,
                           2 * (static_cast<double>(texel / side % side) + v) / size - 1});
      const Vec3d got = Vec3d(patch.corner) + Vec3d(patch.across) * u + Vec3d(patch.up) * v;
      EXPECT_LT(length(normalized(got) - expected), 1e-6);
    }
  }
}

}  // namespace
}  // namespace rimlight
