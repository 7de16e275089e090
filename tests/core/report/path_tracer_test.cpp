#include "core/report/path_tracer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/check.h"
#include "core/basis/cube_map.h"
#include "tests/core/bake/bake_scenes.h"
#include "tests/support/path_tracer.h"

namespace rimlight {
namespace {

constexpr int kCubeSize = 8;

CubeLight uniform_light(float radiance) {
  CubeLight light(kCubeSize);
  for (float& value : light.values) value = radiance;
  return light;
}

/// Every texel its own radiance, some of them black.
CubeLight uneven_light(std::uint64_t seed) {
  CubeLight light(kCubeSize);
  Random random(seed);
  for (std::size_t i = 0; i < light.count(); ++i) {
    const bool black = random.uniform() < 0.3;
    for (int c = 0; c < 3; ++c) {
      light.channel(c)[i] = black ? 0 : static_cast<float>(std::pow(random.uniform(), 4) * 50);
    }
  }
  return light;
}

RgbImage traced(const RayScene& scene, const CubeLight& light, int bounces, int passes) {
  const BakeSettings& bake = scene.scene().bake;
  RgbImage sum(bake.width, bake.height);
  const PathTracer tracer(scene, light, bounces);
  for (int pass = 0; pass < passes; ++pass) {
    tracer.add_pass(1, static_cast<std::uint64_t>(pass), sum);
  }
  for (Vec3f& pixel : sum.pixels) pixel = pixel * (1 / static_cast<float>(passes));
  return sum;
}

TEST(TexelSampler, DrawsByLuminanceAndSolidAngleAndItsDensityIsThat) {
  const CubeLight light = uneven_light(3);
  const TexelSampler sampler(light);
  Random random(5);
  constexpr int kDraws = 200'000;
  // ∫ L dω by its own draws, for each channel; and of the density over the sphere.
  Vec3d sum, squares;
  for (int i = 0; i < kDraws; ++i) {
    const double choice = random.uniform();
    const TexelSampler::Drawn drawn = sampler.draw(choice, random_sample(random));
    EXPECT_NEAR(sampler.density(drawn.direction) / drawn.density, 1, 1e-3);
    EXPECT_EQ(sampler.radiance(drawn.direction), drawn.radiance);
    const Vec3d value = Vec3d(drawn.radiance) / static_cast<double>(drawn.density);
    sum += value;
    squares += value * value;
  }
  const Vec3d exact = integral(light);
  for (int c = 0; c < 3; ++c) {
    const double mean = sum[c] / kDraws;
    const double deviation = std::sqrt((squares[c] / kDraws - mean * mean) / kDraws);
    EXPECT_NEAR(mean, exact[c], 4 * deviation + 1e-6 * exact[c]) << c;
  }
  double total = 0;
  for (int i = 0; i < kDraws; ++i) {
    total += sampler.density(Vec3f(uniform_sphere(random_sample(random))));
  }
  EXPECT_NEAR(total / kDraws * 4 * std::numbers::pi, 1, 0.02);
}

TEST(TexelSampler, OfABlackLightDrawsEverywhere) {
  const CubeLight black = uniform_light(0);
  const TexelSampler sampler(black);
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const TexelSampler::Drawn drawn = sampler.draw(random.uniform(), random_sample(random));
    EXPECT_GT(drawn.density, 0);
    EXPECT_EQ(drawn.radiance, Vec3f{});
  }
}

TEST(PathTracer, AWhiteConvexBoxUnderAUniformSkyIsAsBrightAsTheSky) {
  const RayScene scene(convex_scene(lambert(1)));
  const RgbImage image = traced(scene, uniform_light(2), 3, 64);
  const int width = scene.scene().bake.width, height = scene.scene().bake.height;
  double mean = 0;
  for (int y = -4; y < 4; ++y) {
    for (int x = -4; x < 4; ++x) mean += image.at(width / 2 + x, height / 2 + y).y / 64;
  }
  EXPECT_NEAR(mean, 2, 0.06);
}

/// Against the oracle, which knows one lit texel and samples BRDFs alone.
class PathTracerOracle : public testing::TestWithParam<int> {};

TEST_P(PathTracerOracle, IsThePicturesMean) {
  const int bounces = GetParam();
  for (const Material& material : {lambert(0.8f), metal(0.4f)}) {
    const RayScene scene(corner_scene(material));
    const std::size_t texel = cube::texel_of({0.5, 0.7, 0.6}, kCubeSize);
    CubeLight light(kCubeSize);
    for (int c = 0; c < 3; ++c) light.channel(c)[texel] = 1;
    const int width = scene.scene().bake.width, height = scene.scene().bake.height;
    const test::TexelPathTracer oracle(scene, kCubeSize, texel, bounces);
    Random random(7);
    constexpr int kPasses = 48;
    double expected = 0, spread = 0;
    for (int pass = 0; pass < kPasses; ++pass) {
      double mean = 0;
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) mean += oracle.sample_pixel(x, y, random).y;
      }
      expected += mean / kPasses;
      spread += mean * mean / kPasses;
    }
    const double deviation = std::sqrt((spread - expected * expected) / (kPasses - 1));
    double got = 0;
    for (const Vec3f& pixel : traced(scene, light, bounces, kPasses).pixels) got += pixel.y;
    ASSERT_GT(expected, 0);
    EXPECT_LT(deviation / expected, 0.02);
    EXPECT_NEAR(got, expected, 4.5 * deviation) << "bounces " << bounces;
  }
}
INSTANTIATE_TEST_SUITE_P(Bounces, PathTracerOracle, testing::Values(0, 1, 4));

TEST(PathTracer, HasTheSameBitsForTheSameSeedAndOthersForAnother) {
  const RayScene scene(corner_scene(lambert(0.5f)));
  const CubeLight light = uneven_light(1);
  EXPECT_EQ(traced(scene, light, 2, 2).pixels, traced(scene, light, 2, 2).pixels);
  RgbImage other(scene.scene().bake.width, scene.scene().bake.height);
  PathTracer(scene, light, 2).add_pass(2, 0, other);
  EXPECT_NE(traced(scene, light, 2, 1).pixels, other.pixels);
  RgbImage wrong(3, 3);
  EXPECT_THROW(PathTracer(scene, light, 2).add_pass(2, 0, wrong), CheckFailure);
}

}  // namespace
}  // namespace rimlight
