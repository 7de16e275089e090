#include "core/base/half.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/base/parallel.h"

namespace rimlight {
namespace {

/// What binary16 means, in double.
double meaning(Half half) {
  const int exponent = (half >> 10) & 31;
  const double fraction = half & 1023;
  const double magnitude =
      exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, exponent - 25);
  return (half & 0x8000) != 0 ? -magnitude : magnitude;
}

TEST(Half, EveryFiniteHalfHasItsValueAndComesBack) {
  int finite = 0;
  for (std::uint32_t bits = 0; bits < 65536; ++bits) {
    const auto half = static_cast<Half>(bits);
    if (!is_finite(half)) continue;
    ++finite;
    ASSERT_EQ(static_cast<double>(to_float(half)), meaning(half)) << bits;
    ASSERT_EQ(std::signbit(to_float(half)), bits >= 0x8000) << bits;
    ASSERT_EQ(to_half(to_float(half)), half) << bits;
  }
  EXPECT_EQ(finite, 63488);
}

TEST(Half, InfinityAndNanStayWhatTheyAre) {
  EXPECT_EQ(to_half(std::numeric_limits<float>::infinity()), 0x7c00);
  EXPECT_EQ(to_half(-std::numeric_limits<float>::infinity()), 0xfc00);
  EXPECT_TRUE(std::isinf(to_float(0x7c00)));
  for (std::uint32_t fraction = 1; fraction < 1024; ++fraction) {
    EXPECT_TRUE(std::isnan(to_float(static_cast<Half>(0x7c00 | fraction))));
  }
  EXPECT_TRUE(std::isnan(to_float(to_half(std::numeric_limits<float>::quiet_NaN()))));
  EXPECT_EQ(to_half(std::numeric_limits<float>::max()), 0x7c00);
}

/// Between each two neighbours: the middle goes to the even one, either side of it to the nearer.
TEST(Half, EveryMiddleGoesToTheEvenNeighbourAndItsSidesToTheNearer) {
  for (std::uint32_t bits = 0; bits < 0x7c00; ++bits) {
    const auto low = static_cast<Half>(bits);
    const auto high = static_cast<Half>(bits + 1);
    const double above = bits == 0x7bff ? 65536.0 : meaning(high);
    const auto middle = static_cast<float>((meaning(low) + above) / 2);  // exact: 12 bits
    const Half even = (bits & 1) == 0 ? low : high;
    const float before = std::nextafter(middle, 0.0f);
    const float after = std::nextafter(middle, std::numeric_limits<float>::infinity());
    ASSERT_EQ(to_half(middle), even) << bits;
    ASSERT_EQ(to_half(before), low) << bits;
    ASSERT_EQ(to_half(after), high) << bits;
    ASSERT_EQ(to_half(-middle), even | 0x8000) << bits;
    ASSERT_EQ(to_half(-before), low | 0x8000) << bits;
    ASSERT_EQ(to_half(-after), high | 0x8000) << bits;
  }
}

TEST(Half, RoundingIsMonotone) {
  Half previous = 0;
  std::uint32_t count = 0;
  for (std::uint32_t bits = 0; bits < 0x7f800000u; bits += 1021, ++count) {
    const Half half = to_half(std::bit_cast<float>(bits));
    ASSERT_LE(previous, half) << bits;
    previous = half;
  }
  EXPECT_GT(count, 2'000'000u);
}

TEST(Half, FlushedDenormalsChangeNothing) {
  flush_denormals();
  for (std::uint32_t bits = 0; bits < 0x400; ++bits) {
    const auto half = static_cast<Half>(bits);
    ASSERT_EQ(to_half(to_float(half)), half);
  }
  EXPECT_EQ(to_half(std::numeric_limits<float>::denorm_min()), 0);
}

}  // namespace
}  // namespace rimlight
