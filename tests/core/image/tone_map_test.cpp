#include "core/image/tone_map.h"

#include <gtest/gtest.h>

#include <hwy/targets.h>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include "core/base/check.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

/// The truth: the curve in double, rounded.
int exact_code(float linear) {
  const double x = linear > 0 ? std::min(static_cast<double>(linear), 1.0) : 0.0;
  return static_cast<int>(std::floor(255 * srgb_from_linear(x) + 0.5));
}

/// The bytes of `values`, taken as the red channel, by every SIMD target of this machine.
std::vector<std::vector<std::uint8_t>> codes_of_every_target(const std::vector<float>& values) {
  std::vector<std::vector<std::uint8_t>> result;
  std::vector<std::uint8_t> rgb(3 * values.size());
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    tone_map(values, values, values, 1, rgb);
    std::vector<std::uint8_t>& red = result.emplace_back(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      red[i] = rgb[3 * i];
      EXPECT_TRUE(rgb[3 * i + 1] == red[i] && rgb[3 * i + 2] == red[i]) << values[i];
    }
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  EXPECT_FALSE(result.empty());
  return result;
}

/// Every target is within 1 of the truth, and differs from it on at most `share` of the values.
void expect_codes(const std::vector<float>& values, double share) {
  std::vector<int> truth;
  for (const float value : values) truth.push_back(exact_code(value));
  for (const auto& codes : codes_of_every_target(values)) {
    std::size_t different = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      ASSERT_LE(std::abs(codes[i] - truth[i]), 1) << values[i];
      different += codes[i] != truth[i] ? 1u : 0u;
    }
    EXPECT_LE(static_cast<double>(different), share * static_cast<double>(values.size()));
  }
}

TEST(ToneMap, EveryTargetIsWithinOneOfTheCurveOverAllExponents) {
  std::vector<float> values;
  const auto last = std::bit_cast<std::uint32_t>(1.0f);
  for (std::uint32_t bits = 0; bits < last; bits += 401) {
    values.push_back(std::bit_cast<float>(bits));
  }
  expect_codes(values, 0.001);
}

// The two spreads that images have: even in radiance, and even in bytes.
TEST(ToneMap, EveryTargetEqualsTheCurveOnAllButOneInAThousand) {
  std::vector<float> even_in_radiance;
  std::vector<float> even_in_bytes;
  constexpr int kCount = 400000;
  for (int i = 0; i < kCount; ++i) {
    const double u = (i + 0.5) / kCount;
    even_in_radiance.push_back(static_cast<float>(u));
    even_in_bytes.push_back(static_cast<float>(linear_from_srgb(u)));
  }
  expect_codes(even_in_radiance, 0.001);
  expect_codes(even_in_bytes, 0.001);
}

// The bound that tone_map.cpp derives (2.4e-4 of a byte step), seen to fail with 2e-5 here.
TEST(ToneMap, TheBoundariesBetweenBytesAreWhereTheCurveHasThem) {
  constexpr double kBound = 2.4e-4;
  std::vector<float> values;
  for (int code = 0; code < 255; ++code) {
    for (const double side : {-kBound, kBound}) {
      values.push_back(static_cast<float>(linear_from_srgb((code + 0.5 + side) / 255)));
    }
  }
  expect_codes(values, 0);
}

TEST(ToneMap, ByteValuesSurviveTheWayThereAndBack) {
  std::vector<float> values;
  for (int code = 0; code < 256; ++code) {
    values.push_back(static_cast<float>(linear_from_srgb(code / 255.0)));
  }
  for (const auto& codes : codes_of_every_target(values)) {
    for (std::size_t i = 0; i < codes.size(); ++i) EXPECT_EQ(codes[i], i);
  }
}

TEST(ToneMap, WhatIsOutOfRangeIsClippedAndNanIsBlack) {
  using Limits = std::numeric_limits<float>;
  const std::vector<float> values = {Limits::quiet_NaN(),
                                     -Limits::infinity(),
                                     -1,
                                     -Limits::denorm_min(),
                                     -0.0f,
                                     0,
                                     Limits::denorm_min(),
                                     1,
                                     std::nextafter(1.0f, 2.0f),
                                     1000,
                                     Limits::max(),
                                     Limits::infinity(),
                                     -Limits::quiet_NaN()};
  const std::vector<int> expected = {0, 0, 0, 0, 0, 0, 0, 255, 255, 255, 255, 255, 0};
  for (const auto& codes : codes_of_every_target(values)) {
    for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(codes[i], expected[i]) << values[i];
  }
}

TEST(ToneMap, AByteDoesNotDependOnItsPlaceAndNothingElseIsWritten) {
  Random random(1);
  std::vector<float> planes[3];
  for (auto& plane : planes) {
    for (int i = 0; i < 200; ++i) plane.push_back(random.uniform_float());
  }
  for (std::size_t count = 0; count < 130; ++count) {
    for (std::size_t first = 0; first < 3; ++first) {
      std::vector<std::uint8_t> rgb(3 * count + 8, 77);
      tone_map(
          std::span(planes[0]).subspan(first, count), std::span(planes[1]).subspan(first, count),
          std::span(planes[2]).subspan(first, count), 0.75f, std::span(rgb).subspan(1, 3 * count));
      EXPECT_EQ(rgb.front(), 77);
      for (std::size_t i = 3 * count + 1; i < rgb.size(); ++i) ASSERT_EQ(rgb[i], 77);
      for (std::size_t i = 0; i < 3 * count; ++i) {
        const float value = planes[i % 3][first + i / 3] * 0.75f;
        ASSERT_NEAR(rgb[1 + i], exact_code(value), 1) << count << " " << first << " " << i;
      }
    }
  }
}

TEST(ToneMap, TheScaleMultipliesTheRadiance) {
  std::vector<float> values;
  for (int i = 0; i < 1000; ++i) values.push_back(0.004f * static_cast<float>(i));
  std::vector<float> halves;
  for (const float value : values) halves.push_back(0.5f * value);
  std::vector<std::uint8_t> scaled(3000);
  std::vector<std::uint8_t> plain(3000);
  tone_map(values, values, values, 0.5f, scaled);
  tone_map(halves, halves, halves, 1, plain);
  EXPECT_EQ(scaled, plain);
}

TEST(ToneMap, SpansOfOtherSizesAreABug) {
  const std::vector<float> four(4);
  const std::vector<float> five(5);
  std::vector<std::uint8_t> rgb(12);
  EXPECT_THROW(tone_map(four, five, four, 1, rgb), CheckFailure);
  EXPECT_THROW(tone_map(four, four, five, 1, rgb), CheckFailure);
  EXPECT_THROW(tone_map(five, five, five, 1, rgb), CheckFailure);
}

TEST(SrgbCurve, BothDirectionsAreInverseAndMeetTheStandardsPoints) {
  for (int i = 0; i <= 10000; ++i) {
    const double x = i / 10000.0;
    // The standard's rounded constants leave a step of 3e-8 where line and power meet.
    EXPECT_NEAR(linear_from_srgb(srgb_from_linear(x)), x, 1e-7);
  }
  EXPECT_EQ(srgb_from_linear(0), 0);
  EXPECT_NEAR(srgb_from_linear(1), 1, 1e-15);
  EXPECT_NEAR(srgb_from_linear(0.0031308), 0.04045, 1e-6);
  EXPECT_NEAR(srgb_from_linear(0.5), 0.735357, 1e-6);
  EXPECT_NEAR(linear_from_srgb(0.5), 0.214041, 1e-6);
}

}  // namespace
}  // namespace rimlight
