#include "core/material/merl_brdf.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/math/random.h"
#include "tests/core/material/measured_cases.h"
#include "tests/support/brdf_files.h"
#include "tests/support/error_of.h"

namespace rimlight {
namespace {

constexpr double kPi = std::numbers::pi;

/// The middle of a bin, by the layout's own words.
HalfDifference middle(std::size_t half, std::size_t difference, std::size_t azimuth) {
  const double share = (static_cast<double>(half) + 0.5) / 90;
  return {share * share * kPi / 2, (static_cast<double>(difference) + 0.5) / 90 * kPi / 2,
          (static_cast<double>(azimuth) + 0.5) / 180 * kPi};
}

TEST(MerlBrdf, EveryBinIsFoundByItsMiddleAndReciprocally) {
  for (std::size_t half = 0; half < 90; ++half) {
    for (std::size_t difference = 0; difference < 90; difference += 7) {
      for (std::size_t azimuth = 0; azimuth < 180; azimuth += 11) {
        HalfDifference angles = middle(half, difference, azimuth);
        const std::size_t bin = (half * 90 + difference) * 180 + azimuth;
        ASSERT_EQ(MerlBrdf::bin_of(angles), bin);
        angles.azimuth -= kPi;
        ASSERT_EQ(MerlBrdf::bin_of(angles), bin);
      }
    }
  }
  EXPECT_EQ(MerlBrdf::bin_of({kPi / 2, kPi / 2, kPi}), kMerlBins - 1);
}

TEST(MerlBrdf, HoldsScaledNumbersAndNothingWhereOneIsNegative) {
  const auto stored = [](int channel, std::size_t bin) {
    if (bin % 5 == 0 && channel == 1) return -1e-9;
    return static_cast<double>(bin % 1000) + 1000 * channel;
  };
  const std::string file = test::merl_file(stored);
  ASSERT_EQ(file.size(), 34'992'012u);
  const MerlBrdf brdf(bytes_of(file), "small.binary");
  int valid = 0, empty = 0;
  for (std::size_t half = 0; half < 60; ++half) {
    for (std::size_t azimuth = 0; azimuth < 180; azimuth += 7) {
      const auto value = brdf.at(middle(half, 20, azimuth));
      const std::size_t bin = (half * 90 + 20) * 180 + azimuth;
      ASSERT_EQ(value.has_value(), bin % 5 != 0);
      ++(value ? valid : empty);
      if (!value) continue;
      ASSERT_NEAR(value->x, stored(0, bin) / 1500, 1e-6);
      ASSERT_NEAR(value->y, stored(1, bin) * 1.15 / 1500, 1e-6);
      ASSERT_NEAR(value->z, stored(2, bin) * 1.66 / 1500, 1e-6);
    }
  }
  EXPECT_GT(valid, 1000);
  EXPECT_GT(empty, 200);
  // Both directions must be above the horizon.
  EXPECT_FALSE(brdf.at(middle(85, 80, 3)).has_value());
  EXPECT_FALSE(brdf.at({0, 0.6, 0.8}, {0, 0.6, -0.8}).has_value());
}

TEST(MerlBrdf, RefusesOtherSizesKindsAndNumbers) {
  std::string file = test::merl_file([](int, std::size_t) { return 1.0; });
  const auto error = [&] { return test::error_of([&] { MerlBrdf(bytes_of(file), "f"); }); };
  EXPECT_EQ(error(), "no error");
  file.push_back('\0');
  EXPECT_EQ(error(), "f: found 34992013 bytes, expected 34992012 bytes of a MERL BRDF");
  file.resize(file.size() - 2);
  EXPECT_EQ(error(), "f: found 34992011 bytes, expected 34992012 bytes of a MERL BRDF");
  file.push_back('\0');
  file[0] = 91;
  EXPECT_EQ(error(), "f: header: found 91 90 180 bins, expected 90 90 180 bins");
  file[0] = 90;
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), 1e300,
                           -std::numeric_limits<double>::infinity()}) {
    file.replace(12 + 8 * 5, 8, reinterpret_cast<const char*>(&bad), 8);
    EXPECT_NE(error().find("f: number 5: found"), std::string::npos) << error();
  }
  file.clear();
  EXPECT_NE(error(), "no error");
}

}  // namespace
}  // namespace rimlight
