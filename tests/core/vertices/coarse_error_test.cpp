#include "core/vertices/coarse_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace rimlight {
namespace {

constexpr int kSide = static_cast<int>(TileImage::kSide);

TileImage tile_of(const std::function<float(int, int)>& value) {
  TileImage image;
  for (auto& channel : image.channel) {
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        channel[static_cast<std::size_t>(y * kSide + x)] = value(x, y);
      }
    }
  }
  return image;
}

/// What the missing pixels differ by from the known one in their place.
double truth(const TileImage& image) {
  double sum = 0;
  for (const auto& channel : image.channel) {
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const double difference =
            static_cast<double>(channel[static_cast<std::size_t>(y * kSide + x)]) -
            static_cast<double>(channel[static_cast<std::size_t>((y & ~1) * kSide + (x & ~1))]);
        sum += difference * difference;
      }
    }
  }
  return sum;
}

double ratio(const std::function<float(int, int)>& value) {
  const TileImage image = tile_of(value);
  return std::sqrt(variation_of(image, kSide, kSide).square_of_missing() / truth(image));
}

TEST(CoarseError, IsRightForSlopesAndWaves) {
  EXPECT_NEAR(ratio([](int x, int y) { return 0.3f * static_cast<float>(x + 2 * y); }), 1, 1e-4);
  EXPECT_NEAR(ratio([](int x, int y) {
                return std::sin(0.2f * static_cast<float>(x)) +
                       std::cos(0.15f * static_cast<float>(y));
              }),
              1, 0.06);
}

TEST(CoarseError, IsNearForADisc) {
  for (const float radius : {9.3f, 17.6f, 24.1f}) {
    EXPECT_NEAR(ratio([&](int x, int y) {
                  return std::hypot(static_cast<float>(x) - 31.7f, static_cast<float>(y) - 30.2f) <
                                 radius
                             ? 1.0f
                             : 0.0f;
                }),
                1, 0.2);
  }
}

TEST(CoarseError, EvenTilesHaveNone) {
  const TileImage image = tile_of([](int, int) { return 0.7f; });
  const TileVariation variation = variation_of(image, kSide, kSide);
  EXPECT_EQ(variation.square_of_missing(), 0);
  EXPECT_EQ(variation.known, 32u * 32u);
  EXPECT_EQ(variation_of(image, 1, 1).square_of_missing(), 0);
  EXPECT_EQ(variation_of(image, 5, 3).known, 6u);
}

}  // namespace
}  // namespace rimlight
