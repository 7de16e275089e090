#include "core/image/metrics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/check.h"
#include "core/image/tone_map.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

std::vector<Vec3f> random_radiance(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3f> result(count);
  for (Vec3f& value : result) {
    for (int c = 0; c < 3; ++c) value[c] = static_cast<float>(std::exp(random.uniform(-6, 3)));
  }
  return result;
}

double code(double linear) {
  return std::floor(255 * srgb_from_linear(std::clamp(linear, 0.0, 1.0)) + 0.5);
}

TEST(AutoExposure, TakesAUniformImageToMiddleGrey) {
  for (const float level : {1e-6f, 0.18f, 7.0f, 1e6f}) {
    EXPECT_NEAR(auto_exposure_scale(std::vector(50, Vec3f::filled(level))) * level, 0.18, 1e-12);
  }
}

TEST(AutoExposure, IsTheClampedMeanOfASortedCopy) {
  for (const std::size_t count : {1u, 2u, 33u, 100u, 1000u}) {
    const std::vector<Vec3f> radiance = random_radiance(count, count);
    std::vector<double> values;
    for (const Vec3f& value : radiance) {
      for (int c = 0; c < 3; ++c) values.push_back(value[c]);
    }
    std::sort(values.begin(), values.end());
    const double most = values[(values.size() - 1) * 99 / 100];
    double mean = 0;
    for (const double value : values) {
      mean += std::min(value, most) / static_cast<double>(values.size());
    }
    EXPECT_NEAR(auto_exposure_scale(radiance) * mean, 0.18, 1e-12) << count;
  }
}

TEST(AutoExposure, AFewBrightValuesChangeLittle) {
  std::vector<Vec3f> radiance = random_radiance(1000, 1);
  const double before = auto_exposure_scale(radiance);
  for (std::size_t i = 0; i < 5; ++i) radiance[100 * i] = Vec3f::filled(1e8f);
  // 0.5 % of the values move to the clamp, which moves up by half a percentile.
  EXPECT_NEAR(auto_exposure_scale(radiance) / before, 1, 0.1);
}

TEST(AutoExposure, WithoutLightItIsOne) {
  EXPECT_EQ(auto_exposure_scale({}), 1);
  EXPECT_EQ(auto_exposure_scale(std::vector<Vec3f>(9)), 1);
  EXPECT_EQ(auto_exposure_scale(std::vector(9, Vec3f::filled(-1))), 1);
  EXPECT_EQ(auto_exposure_scale(std::vector(9, Vec3f::filled(kNan))), 1);
  EXPECT_EQ(auto_exposure_scale(std::vector(9, Vec3f::filled(kInfinity))), 1);
}

TEST(DisplayPsnr, OneCodeEverywhereIs48Decibels) {
  const std::vector<Vec3f> image(64,
                                 Vec3f::filled(static_cast<float>(linear_from_srgb(100 / 255.0))));
  const std::vector<Vec3f> other(64,
                                 Vec3f::filled(static_cast<float>(linear_from_srgb(101 / 255.0))));
  EXPECT_NEAR(display_psnr(image, other, 1), 20 * std::log10(255.0), 1e-9);
}

TEST(DisplayPsnr, EqualsTheCurveTakenValueByValue) {
  const std::vector<Vec3f> image = random_radiance(5000, 2);
  const std::vector<Vec3f> reference = random_radiance(5000, 3);
  for (const double scale : {0.01, 0.7, 3.0}) {
    double mean = 0;
    for (std::size_t i = 0; i < image.size(); ++i) {
      for (int c = 0; c < 3; ++c) {
        const double d = code(scale * image[i][c]) - code(scale * reference[i][c]);
        mean += d * d / (3.0 * 5000);
      }
    }
    EXPECT_NEAR(display_psnr(image, reference, scale), 10 * std::log10(255 * 255 / mean), 1e-9);
  }
}

TEST(DisplayPsnr, EqualImagesAreAtTheCapAndClippedLightDoesNotCount) {
  const std::vector<Vec3f> image = random_radiance(100, 4);
  EXPECT_EQ(display_psnr(image, image, 1), 99);
  EXPECT_EQ(display_psnr({}, {}, 1), 99);
  EXPECT_EQ(display_psnr(std::vector(4, Vec3f::filled(2)), std::vector(4, Vec3f::filled(50)), 1),
            99);
  EXPECT_NEAR(
      display_psnr(std::vector(4, Vec3f::filled(kNan)), std::vector(4, Vec3f::filled(1)), 1), 0,
      1e-12);
}

TEST(DisplayPsnr, FallsWithNoise) {
  const std::vector<Vec3f> reference = random_radiance(3000, 5);
  double before = 100;
  for (const double noise : {0.003, 0.01, 0.03, 0.1, 0.3}) {
    Random random(6);
    std::vector<Vec3f> image = reference;
    for (Vec3f& value : image) value *= static_cast<float>(1 + noise * random.uniform(-1, 1));
    const double psnr = display_psnr(image, reference, 0.2);
    EXPECT_LT(psnr, before) << noise;
    before = psnr;
  }
}

TEST(RelativeL2, OfAScaledImageIsTheChange) {
  const std::vector<Vec3f> reference = random_radiance(1000, 7);
  std::vector<Vec3f> image = reference;
  for (Vec3f& value : image) value *= 1.25f;
  EXPECT_NEAR(relative_l2(image, reference), 0.25, 1e-7);  // the products round in float
  EXPECT_EQ(relative_l2(reference, reference), 0);
}

TEST(RelativeL2, BlackReferencesAndNanAreNotHidden) {
  const std::vector<Vec3f> black(3);
  const std::vector<Vec3f> white(3, Vec3f::filled(1));
  const std::vector<Vec3f> broken(3, Vec3f::filled(kNan));
  EXPECT_EQ(relative_l2(black, black), 0);
  EXPECT_EQ(relative_l2(white, black), std::numeric_limits<double>::infinity());
  EXPECT_EQ(relative_l2(black, white), 1);
  EXPECT_TRUE(std::isnan(relative_l2(broken, white)));
  EXPECT_TRUE(std::isnan(relative_l2(white, broken)));
  EXPECT_GT(relative_l2(broken, black), 1e300);
}

TEST(Metrics, SpansOfOtherSizesAreABug) {
  const std::vector<Vec3f> four(4);
  const std::vector<Vec3f> five(5);
  EXPECT_THROW(display_psnr(four, five, 1), CheckFailure);
  EXPECT_THROW(relative_l2(four, five), CheckFailure);
}

}  // namespace
}  // namespace rimlight
