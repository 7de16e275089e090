#include "core/report/light_study.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/math/random.h"

namespace rimlight {
namespace {

constexpr int kSize = 8;

CubeLight random_coefficients(std::uint64_t seed) {
  CubeLight light(kSize);
  Random random(seed);
  for (float& value : light.values) value = static_cast<float>(random.uniform(-1, 1));
  return light;
}

CubeLight to_coefficients(const CubeHaar& haar, CubeLight texels) {
  CubeLight result(haar.size());
  for (int c = 0; c < 3; ++c) haar.forward(texels.channel(c), result.channel(c));
  return result;
}

double square_of(const CubeLight& light) {
  double square = 0;
  for (const float value : light.values) square += static_cast<double>(value) * value;
  return square;
}

TEST(SpatioTemporalNorms, AreAllOfTheEnergyOfTheFramesThatTheyCover) {
  const CubeHaar haar(kSize);
  std::vector<CubeLight> frames;
  double expected = 0;
  for (std::uint64_t i = 0; i < 11; ++i) {  // the first eight count
    frames.push_back(random_coefficients(i + 1));
    if (i < 8) expected += square_of(frames.back());
  }
  const auto norms = spatio_temporal_norms(haar, frames);
  ASSERT_EQ(norms.size(), 4u);  // the mean, and differences over 8, 4 and 2 frames
  double found = 0;
  for (const auto& row : norms) {
    ASSERT_EQ(row.size(), static_cast<std::size_t>(haar.band_count()));
    for (const double norm : row) found += norm * norm;
  }
  EXPECT_NEAR(found, expected, 1e-9 * expected);
}

TEST(SpatioTemporalNorms, PutStillLightInTheMeanAndFlickerInTheFinestBand) {
  const CubeHaar haar(kSize);
  const CubeLight light = random_coefficients(3);
  CubeLight negative = light;
  for (float& value : negative.values) value = -value;
  const std::vector<CubeLight> still(8, light);
  const std::vector<CubeLight> flicker = {light, negative, light, negative};
  const auto of_still = spatio_temporal_norms(haar, still);
  const auto of_flicker = spatio_temporal_norms(haar, flicker);
  for (std::size_t band = 0; band < of_still[0].size(); ++band) {
    EXPECT_GT(of_still[0][band], 1);
    for (std::size_t t = 1; t < of_still.size(); ++t) EXPECT_NEAR(of_still[t][band], 0, 1e-6);
    EXPECT_GT(of_flicker.back()[band], 1);
    for (std::size_t t = 0; t + 1 < of_flicker.size(); ++t) {
      EXPECT_NEAR(of_flicker[t][band], 0, 1e-6);
    }
  }
  EXPECT_TRUE(spatio_temporal_norms(haar, {}).empty());
}

TEST(GhostEnergy, IsWhatIsHeldWhereTheTargetIsDark) {
  const CubeHaar haar(kSize);
  CubeLight asked(kSize), shown(kSize);
  for (int c = 0; c < 3; ++c) {
    asked.channel(c)[7] = 10;
    asked.channel(c)[100] = 0.05f;  // under a hundredth of the peak
    shown.channel(c)[7] = 8;        // bright: no ghost
    shown.channel(c)[100] = 0.05f;
    shown.channel(c)[200] = 5;  // where a light was
  }
  const CubeLight target = to_coefficients(haar, asked);
  const GhostEnergy ghosts = find_ghosts(haar, target, to_coefficients(haar, shown));
  const double whole = 10 * 10 + 0.05 * 0.05;
  EXPECT_NEAR(ghosts.held, (25 + 0.05 * 0.05) / whole, 1e-6);
  EXPECT_NEAR(ghosts.target, 0.05 * 0.05 / whole, 1e-6);
  const GhostEnergy exact = find_ghosts(haar, target, target);
  EXPECT_EQ(exact.held, exact.target);
  EXPECT_EQ(find_ghosts(haar, CubeLight(kSize), target).held, 0);
}

// The support of each wavelet, as the inverse transform of a unit coefficient shows it.
TEST(Coverage, MarksExactlyTheTexelsUnderEachWavelet) {
  const CubeHaar haar(kSize);
  for (std::size_t column = 0; column < haar.coefficient_count(); ++column) {
    std::vector<float> unit(haar.coefficient_count()), texels(haar.coefficient_count());
    unit[column] = 1;
    haar.inverse(unit, texels);
    const std::vector<std::vector<std::uint32_t>> frames = {{static_cast<std::uint32_t>(column)}};
    const Coverage coverage = find_coverage(haar, frames);
    for (std::size_t i = 0; i < texels.size(); ++i) {
      ASSERT_EQ(coverage.bands_over_texel[i], texels[i] != 0 ? 1 : 0) << column << " " << i;
    }
  }
}

TEST(Coverage, AveragesFramesAndCountsEachColumnOnce) {
  const CubeHaar haar(kSize);
  const auto finest = static_cast<std::uint32_t>(haar.band_begin(2));
  const std::vector<std::vector<std::uint32_t>> frames = {{0, 1, finest}, {0}, {}, {0}};
  const Coverage coverage = find_coverage(haar, frames);
  EXPECT_EQ(coverage.columns_of_band, (std::vector<int>{2, 0, 1}));
  EXPECT_DOUBLE_EQ(coverage.bands_over_texel[0], (2 + 1 + 0 + 1) / 4.0);
  EXPECT_DOUBLE_EQ(coverage.bands_over_texel[kSize * kSize - 1], (1 + 1 + 0 + 1) / 4.0);
  EXPECT_EQ(coverage.bands_over_texel.back(), 0);
}

}  // namespace
}  // namespace rimlight
