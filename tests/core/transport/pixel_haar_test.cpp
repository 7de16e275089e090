#include "core/transport/pixel_haar.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "core/math/random.h"
#include "tests/support/reference/pixel_haar.h"

namespace rimlight {
namespace {

constexpr std::size_t kLanes = PixelLayout::kGroupReceivers;
using Group = std::array<float, kLanes>;

Group random_group(std::uint64_t seed) {
  Random random(seed);
  Group group;
  for (float& value : group) value = static_cast<float>(random.uniform(-1, 1));
  return group;
}

TEST(PixelHaar, TheFunctionsAreOrthonormal) {
  for (std::size_t i = 0; i < kLanes; ++i) {
    for (std::size_t j = 0; j < kLanes; ++j) {
      double product = 0;
      for (std::size_t at = 0; at < kLanes; ++at) {
        product += reference::pixel_haar_function(i, at) * reference::pixel_haar_function(j, at);
      }
      ASSERT_NEAR(product, i == j ? 1 : 0, 1e-12) << i << " " << j;
    }
  }
}

TEST(PixelHaar, ForwardIsTheProductWithEachFunction) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Group group = random_group(seed);
    Group found = group;
    pixel_haar_forward(found.data(), kBlockReceivers);
    for (std::size_t i = 0; i < kLanes; ++i) {
      double expected = 0;
      for (std::size_t at = 0; at < kLanes; ++at) {
        expected += reference::pixel_haar_function(i, at) * static_cast<double>(group[at]);
      }
      ASSERT_NEAR(found[i], expected, 4e-6) << i;
    }
  }
}

TEST(PixelHaar, InverseTakesForwardBack) {
  const Group group = random_group(3);
  Group found = group;
  pixel_haar_forward(found.data(), kBlockReceivers);
  EXPECT_NE(found, group);
  pixel_haar_inverse(found.data(), kBlockReceivers);
  for (std::size_t i = 0; i < kLanes; ++i) ASSERT_NEAR(found[i], group[i], 1e-6) << i;
}

TEST(PixelHaar, AConstantIsOneCoefficientAndARampHasNoDiagonals) {
  Group constant;
  constant.fill(0.25f);
  pixel_haar_forward(constant.data(), kBlockReceivers);
  EXPECT_EQ(constant[0], 2);
  for (std::size_t i = 1; i < kLanes; ++i) ASSERT_EQ(constant[i], 0) << i;
  Group ramp;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const auto [x, y] = PixelLayout{64, 64}.pixel(i);
    ramp[i] = static_cast<float>(x + 2 * y);
  }
  pixel_haar_forward(ramp.data(), kBlockReceivers);
  EXPECT_EQ(ramp[3], 0);
  for (std::size_t i = 12; i < 16; ++i) ASSERT_EQ(ramp[i], 0) << i;
  for (std::size_t i = 16; i < 32; ++i) ASSERT_EQ(ramp[i], -1) << i;  // across x: slope 1
  for (std::size_t i = 32; i < 48; ++i) ASSERT_EQ(ramp[i], -2) << i;
  for (std::size_t i = 48; i < 64; ++i) ASSERT_EQ(ramp[i], 0) << i;
}

TEST(PixelHaar, BlocksMayLieApart) {
  const Group group = random_group(5);
  std::vector<float> apart(kBlockFloats * 8, 7.0f);
  for (std::size_t i = 0; i < kLanes; ++i) apart[i / 8 * kBlockFloats + i % 8] = group[i];
  Group together = group;
  pixel_haar_forward(together.data(), kBlockReceivers);
  pixel_haar_forward(apart.data(), kBlockFloats);
  for (std::size_t i = 0; i < apart.size(); ++i) {
    const bool in_group = i % kBlockFloats < kBlockReceivers;
    ASSERT_EQ(apart[i], in_group ? together[i / kBlockFloats * 8 + i % kBlockFloats] : 7.0f);
  }
}

TEST(PixelHaar, ATileIsItsGroupsAndChannelsEachByItself) {
  Random random(8);
  AlignedVector<float> tile(kTileFloats);
  for (float& value : tile) value = static_cast<float>(random.uniform(-1, 1));
  const std::vector<double> held(tile.begin(), tile.end());
  const std::vector<float> ones(kTileFloats, 1.0f);
  const auto expected = reference::restore_radiance(held, ones, false);
  pixel_haar_inverse_tile(tile.data());
  for (std::size_t i = 0; i < kTileFloats; ++i) ASSERT_NEAR(tile[i], expected[i], 4e-6) << i;
}

}  // namespace
}  // namespace rimlight
