#include "core/relight/background.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/math/random.h"
#include "core/math/sampling.h"
#include "core/relight/tile_image.h"

namespace rimlight {
namespace {

CubeLight random_texels(int size, std::uint64_t seed) {
  CubeLight light(size);
  Random random(seed);
  for (float& value : light.values) value = random.uniform_float();
  return light;
}

Vec3d random_direction(Random& random) { return uniform_sphere(random_sample(random)); }

TEST(BackgroundMap, AUniformEnvironmentIsUniformEverywhere) {
  CubeLight light(8);
  std::ranges::fill(light.values, 0.7f);
  const BackgroundMap map(light);
  Random random(1);
  for (int i = 0; i < 10'000; ++i) {
    const Vec3f found = map.at(Vec3f(random_direction(random)));
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(found[c], 0.7f, 1e-7);
  }
}

TEST(BackgroundMap, GivesEachTexelAtItsMiddle) {
  const CubeLight light = random_texels(16, 2);
  const BackgroundMap map(light);
  for (std::size_t texel = 0; texel < light.count(); ++texel) {
    const Vec3f found = map.at(Vec3f(cube::texel_direction(texel, 16)));
    // The place is a float of up to 17, good to 2⁻¹⁹ or so; values differ by at most 1.
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(found[c], light.at(texel)[c], 1e-5) << texel;
  }
}

/// Bilinear inside a face, away from its border, in double.
TEST(BackgroundMap, IsBilinearBetweenMiddles) {
  constexpr int kSize = 16;
  const CubeLight light = random_texels(kSize, 3);
  const BackgroundMap map(light);
  Random random(4);
  int compared = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Vec3d d = random_direction(random);
    const cube::FacePoint point = cube::face_point(d);
    const double x = (point.x + 1) / 2 * kSize - 0.5, y = (point.y + 1) / 2 * kSize - 0.5;
    if (x < 0 || y < 0 || x >= kSize - 1 || y >= kSize - 1) continue;
    ++compared;
    const auto column = static_cast<int>(x), row = static_cast<int>(y);
    for (int c = 0; c < 3; ++c) {
      const auto texel = [&](int r, int k) {
        return double{light.at(static_cast<std::size_t>((point.face * kSize + r) * kSize + k))[c]};
      };
      const double s = x - column, t = y - row;
      const double expected =
          (1 - t) * ((1 - s) * texel(row, column) + s * texel(row, column + 1)) +
          t * ((1 - s) * texel(row + 1, column) + s * texel(row + 1, column + 1));
      ASSERT_NEAR(map.at(Vec3f(d))[c], expected, 2e-5);
    }
  }
  EXPECT_GT(compared, 10'000);
}

TEST(BackgroundMap, IsContinuousOverEdgesAndCorners) {
  constexpr int kSize = 8;
  const BackgroundMap map(random_texels(kSize, 5));
  Random random(6);
  double worst = 0;
  constexpr double kStep = 1e-4;
  int crossings = 0;
  for (int i = 0; i < 200'000; ++i) {
    Vec3d d = random_direction(random);
    // Onto an edge: two components of one size; every tenth onto a corner.
    const double largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    const int other = static_cast<int>(random.below(3));
    d[other] = std::copysign(largest, d[other]);
    if (i % 10 == 0) d = {std::copysign(1, d.x), std::copysign(1, d.y), std::copysign(1, d.z)};
    const Vec3d a = normalized(d) + kStep * random_direction(random);
    const Vec3d b = normalized(d) + kStep * random_direction(random);
    crossings += cube::face_point(a).face != cube::face_point(b).face;
    for (int c = 0; c < 3; ++c) {
      worst = std::max(worst, std::abs(double{map.at(Vec3f(a))[c]} - map.at(Vec3f(b))[c]));
    }
  }
  EXPECT_GT(crossings, 10'000);
  // Neighbouring texels' borders are the mean of both sides but for where along the edge the two
  // faces' texels lie, which is the same: a step of 10⁻⁴ · 2 moves by 10⁻³ texels or so.
  EXPECT_LT(worst, 0.01);
}

TEST(BackgroundPixels, AreThoseThatAreNotCoveredWithTheirRays) {
  const PixelLayout layout{100, 70};
  Camera camera;
  camera.position = {3, 1, -2};
  std::vector<float> coverage(100 * 70);
  Random random(7);
  for (float& share : coverage) share = random.uniform() < 0.5 ? 1.0f : random.uniform_float();
  const BackgroundPixels pixels(layout, camera, coverage);
  std::size_t found = 0;
  for (std::size_t tile = 0; tile < layout.tile_count(); ++tile) {
    const auto corner = layout.pixel(tile * kTileReceivers);
    for (const BackgroundPixels::Pixel& pixel : pixels.of_tile(tile)) {
      const int x = corner.x + pixel.x, y = corner.y + pixel.y;
      ASSERT_LT(x, 100);
      ASSERT_LT(y, 70);
      ASSERT_EQ(pixel.share, 1 - coverage[static_cast<std::size_t>(y * 100 + x)]);
      const Vec3d ray = camera.ray_direction(x + 0.5, y + 0.5, 100, 70);
      ASSERT_LT(length(Vec3d(pixel.direction) - ray), 1e-6);
      ++found;
    }
  }
  EXPECT_EQ(found, static_cast<std::size_t>(
                       std::ranges::count_if(coverage, [](float s) { return s < 1; })));
}

TEST(TileImage, PutsEachReceiverAtItsPixel) {
  const PixelLayout layout{64, 64};
  AlignedVector<float> radiance(kTileFloats);
  for (std::size_t i = 0; i < kTileFloats; ++i) radiance[i] = static_cast<float>(i);
  TileImage image;
  rows_from_blocks(std::span<const float, kTileFloats>(radiance.data(), kTileFloats), image);
  for (std::size_t receiver = 0; receiver < kTileReceivers; ++receiver) {
    const auto pixel = layout.pixel(receiver);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t lane = receiver / 8 * kBlockFloats + c * 8 + receiver % 8;
      ASSERT_EQ(image.channel[c][static_cast<std::size_t>(pixel.y * 64 + pixel.x)], radiance[lane]);
    }
  }
}

}  // namespace
}  // namespace rimlight
