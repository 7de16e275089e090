#include "core/light/cube_splat.h"

#include <gtest/gtest.h>

#include <map>

#include "core/math/sampling.h"
#include "tests/core/light/light_samples.h"

namespace rimlight {
namespace {

std::map<std::uint32_t, double> shares_of(const CubeSplat& splat, const Vec3d& direction) {
  std::map<std::uint32_t, double> result;
  const SplatShares shares = splat.shares(cube::face_point(direction));
  for (std::size_t i = 0; i < 4; ++i) {
    result[shares.texel[i]] += static_cast<double>(shares.weight[i]);
  }
  return result;
}

/// Random directions, and ones close to edges and vertices of the cube.
std::vector<Vec3d> directions(int count) {
  Random random(51);
  std::vector<Vec3d> result;
  for (int i = 0; i < count; ++i) {
    Vec3d d = uniform_sphere(random_sample(random));
    if (i % 3 == 1) d[i % 2] = d[2] * random.uniform(0.98, 1.02);
    if (i % 3 == 2) d = {random.uniform(0.95, 1.05), -random.uniform(0.95, 1.05), 1};
    result.push_back(normalized(d));
  }
  return result;
}

TEST(CubeSplat, SharesSumToOneAndAreNotNegative) {
  for (const int size : {2, 16, 64}) {
    const CubeSplat splat(size);
    for (const Vec3d& direction : directions(20000)) {
      double sum = 0;
      for (const auto& [texel, share] : shares_of(splat, direction)) {
        ASSERT_GE(share, 0);
        ASSERT_LT(texel, cube::texel_count(size));
        sum += share;
      }
      ASSERT_NEAR(sum, 1, 3e-7);
    }
  }
}

TEST(CubeSplat, TheMeanDirectionIsTheDirection) {
  // The shares are exact in a plane; on the sphere the four middles' different lengths shift the
  // mean by the square of a texel.
  for (const int size : {16, 64}) {
    const CubeSplat splat(size);
    double worst = 0;
    for (const Vec3d& direction : directions(20000)) {
      Vec3d mean;
      for (const auto& [texel, share] : shares_of(splat, direction)) {
        mean += cube::texel_direction(texel, size) * share;
      }
      const double width =
          std::sqrt(cube::texel_solid_angle(cube::texel_of(direction, size), size));
      worst = std::max(worst, angle_between(mean, direction) / width);
    }
    EXPECT_LE(worst, 0.5 / size);
  }
}

TEST(CubeSplat, IsContinuousEverywhere) {
  constexpr int kSize = 16;
  constexpr double kStep = 1e-6;
  const CubeSplat splat(kSize);
  Random random(52);
  for (const Vec3d& direction : directions(30000)) {
    const auto before = shares_of(splat, direction);
    auto after = shares_of(splat, direction + uniform_sphere(random_sample(random)) * kStep);
    double change = 0;
    for (const auto& [texel, share] : before) change += std::abs(share - after[texel]);
    for (const auto& [texel, share] : after) change += before.contains(texel) ? 0 : share;
    // Four weights, each of slope at most 1/width on each axis; the narrowest texel is 2/3 ·
    // 1/size.
    ASSERT_LE(change, 8 * kStep / (2.0 / 3 / kSize) + 1e-6);
  }
}

TEST(CubeSplat, ATexelsMiddleIsAllItsOwn) {
  for (const int size : {2, 16}) {
    const CubeSplat splat(size);
    for (std::uint32_t t = 0; t < cube::texel_count(size); ++t) {
      ASSERT_NEAR(shares_of(splat, cube::texel_direction(t, size))[t], 1, 1e-6);
    }
  }
}

TEST(CubeSplat, AVertexIsSharedByItsThreeTexelsInThirds) {
  const CubeSplat splat(16);
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) {
        int texels = 0;
        for (const auto& [texel, share] : shares_of(splat, {x, y, z})) {
          if (share == 0) continue;
          EXPECT_NEAR(share, 1.0 / 3, 1e-6);
          ++texels;
        }
        EXPECT_EQ(texels, 3);
      }
    }
  }
}

}  // namespace
}  // namespace rimlight
