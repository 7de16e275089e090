#include "core/image/picture_scaler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/image/tone_map.h"
#include "tests/core/image/encoded_pictures.h"
#include "tests/support/allocation_count.h"

namespace rimlight {
namespace {

using namespace test;  // NOLINT: the makers of pictures

std::size_t index(const Rgb8Image& image, int x, int y, int channel) {
  return 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
              static_cast<std::size_t>(x)) +
         static_cast<std::size_t>(channel);
}

/// The mean light of what one small pixel covers, in double, as an sRGB byte before rounding.
double mean(const Rgb8Image& image, int divisor, int x, int y, int channel) {
  double sum = 0;
  int count = 0;
  for (int v = y * divisor; v < std::min((y + 1) * divisor, image.height); ++v) {
    for (int u = x * divisor; u < std::min((x + 1) * divisor, image.width); ++u, ++count) {
      sum += linear_from_srgb(image.bytes[index(image, u, v, channel)] / 255.0);
    }
  }
  return 255 * srgb_from_linear(sum / count);
}

TEST(PictureScaler, EachPixelIsTheMeanLightOfThoseItCoversAtAnySize) {
  const PictureScaler scaler;
  double worst = 0;
  for (const auto& [width, height] : {std::pair(1, 1), {7, 1}, {1, 9}, {64, 48}, {61, 47}}) {
    const Rgb8Image image = random_bytes_image(width, height, 3);
    for (const int divisor : {1, 2, 3, 4, 16}) {
      Rgb8Image small;
      scaler.shrink(image, divisor, small);
      ASSERT_EQ(small.width, (width + divisor - 1) / divisor);
      ASSERT_EQ(small.height, (height + divisor - 1) / divisor);
      for (int y = 0; y < small.height; ++y) {
        for (int x = 0; x < small.width; ++x) {
          for (int c = 0; c < 3; ++c) {
            const double error =
                std::abs(small.bytes[index(small, x, y, c)] - mean(image, divisor, x, y, c));
            worst = std::max(worst, error);
          }
        }
      }
    }
  }
  EXPECT_LE(worst, 1);
  EXPECT_GT(worst, 0.3);  // rounding is there at all
}

TEST(PictureScaler, ByOneIsTheSamePictureAndOneShadeStaysWhatItIs) {
  const PictureScaler scaler;
  Rgb8Image small;
  const Rgb8Image image = random_bytes_image(33, 21, 5);
  scaler.shrink(image, 1, small);
  EXPECT_EQ(small.bytes, image.bytes);
  for (int shade = 0; shade < 256; ++shade) {
    Rgb8Image even = random_bytes_image(5, 5, 1);
    std::fill(even.bytes.begin(), even.bytes.end(), static_cast<std::uint8_t>(shade));
    scaler.shrink(even, 2, small);
    for (const std::uint8_t byte : small.bytes) ASSERT_EQ(byte, shade);
  }
}

TEST(PictureScaler, AHighlightKeepsItsLight) {
  const PictureScaler scaler;
  Rgb8Image image = random_bytes_image(2, 2, 1), small;
  for (std::size_t i = 0; i < image.bytes.size(); ++i) image.bytes[i] = i < 3 ? 255 : 0;
  scaler.shrink(image, 2, small);
  EXPECT_EQ(small.bytes[0], 137);  // a quarter of the light; the mean of the bytes is 64
}

TEST(PictureScaler, AllocatesNothingAfterTheFirstPicture) {
  if (!kCountsAllocations) GTEST_SKIP() << "ThreadSanitizer keeps operator new to itself";
  const PictureScaler scaler;
  const Rgb8Image image = smooth_image(320, 200);
  Rgb8Image small;
  scaler.shrink(image, 2, small);
  const std::size_t warm = allocation_count();
  for (int i = 0; i < 10; ++i) scaler.shrink(image, 2, small);
  EXPECT_EQ(allocation_count(), warm);
}

}  // namespace
}  // namespace rimlight
