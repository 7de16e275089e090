// Energy under a uniform sky of radiance 1, where the right answer is known without any renderer.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/bake/direct_transport.h"
#include "core/bake/indirect_transport.h"
#include "core/transport/receivers.h"
#include "tests/core/bake/bake_scenes.h"

namespace rimlight {
namespace {

/// Mean, spread and number of covered pixels' radiance, per unit of coverage.
struct Statistics {
  double sum = 0, squares = 0, largest = 0;
  int count = 0;

  void add(double value) {
    sum += value;
    squares += value * value;
    largest = std::max(largest, value);
    ++count;
  }
  double mean() const { return sum / count; }
  /// Of the mean, as if pixels were independent.
  double standard_error() const {
    return std::sqrt(std::max(0.0, squares / count - mean() * mean()) / count);
  }
};

/// Every third group of the scene under the uniform sky, channel by channel.
std::array<Statistics, 3> uniform_sky(const std::shared_ptr<Scene>& scene, std::size_t step = 3) {
  const RayScene rays(scene);
  const BakeSettings& bake = scene->bake;
  const DirectTransport direct(rays, bake.cube_size);
  IndirectSettings settings;
  settings.cube_size = bake.cube_size;
  settings.bounces = bake.bounces;
  const IndirectTransport indirect(rays, settings);
  const PixelLayout layout{bake.width, bake.height};
  std::array<Statistics, 3> statistics;
  GroupRows rows(bake.cube_size);
  GroupSamples samples;
  for (std::size_t group = 0; group < 64; group += step) {
    sample_group(rays, layout, group * kGroupLanes, bake.primary_rays, bake.seed, samples);
    if (samples.empty()) continue;
    std::fill(rows.values.begin(), rows.values.end(), 0.0f);
    direct.add(samples, group, rows);
    indirect.add(samples, group, rows);
    for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
      const double coverage = samples.coverage(lane);
      if (coverage == 0) continue;
      for (std::size_t channel = 0; channel < 3; ++channel) {
        double sum = 0;
        for (std::size_t texel = 0; texel < cube::texel_count(bake.cube_size); ++texel) {
          sum += rows.row(texel)[channel * kGroupLanes + lane];
        }
        statistics[channel].add(sum / coverage);
      }
    }
  }
  return statistics;
}

TEST(BakeEnergy, AConvexWhiteLambertObjectUnderAUniformSkyIsOne) {
  const Statistics measured = uniform_sky(convex_scene(lambert(1)))[0];
  ASSERT_GT(measured.count, 500);
  EXPECT_NEAR(measured.mean(), 1, 1e-3);
  EXPECT_LT(measured.largest, 1.01);
}

TEST(BakeEnergy, AWhiteLambertSceneWithoutBounceLimitIsOne) {
  const auto scene = corner_scene(lambert(1));
  scene->bake.bounces = 64;
  const Statistics measured = uniform_sky(scene)[1];
  ASSERT_GT(measured.count, 500);
  // A group's 64 pixels share their second points: they are not independent, so the error is taken
  // as if a group were one sample.
  EXPECT_NEAR(measured.mean(), 1, 3 * 8 * measured.standard_error());
  EXPECT_NEAR(measured.mean(), 1, 0.01);
}

TEST(BakeEnergy, LessAlbedoGivesLessAndNeverMoreThanTheSky) {
  const auto scene = corner_scene(lambert(0.5f));
  const Statistics measured = uniform_sky(scene)[2];
  // Between one reflection of the open sky seen from a corner and no loss but the albedo's.
  EXPECT_GT(measured.mean(), 0.25);
  EXPECT_LT(measured.largest, 0.51);
}

TEST(BakeEnergy, AMetalSceneReflectsAtMostTheSky) {
  for (const float roughness : {0.15f, 0.5f}) {
    const auto scene = corner_scene(metal(roughness));
    scene->bake.cube_size = 8;
    scene->bake.primary_rays = 4;
    for (const Statistics& measured : uniform_sky(scene, 7)) {
      ASSERT_GT(measured.count, 100);
      EXPECT_LT(measured.mean(), 1) << "roughness " << roughness;
      EXPECT_GT(measured.mean(), 0.15) << "roughness " << roughness;
    }
  }
}

}  // namespace
}  // namespace rimlight
