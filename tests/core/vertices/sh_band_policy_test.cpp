#include "core/vertices/sh_band_policy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/check.h"
#include "core/basis/sh.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

constexpr int kDegree = 6;
constexpr std::size_t kCount = sh::coefficient_count(kDegree);

std::vector<float> random_light(std::uint64_t seed) {
  std::vector<float> light(3 * kCount);
  Random random(seed);
  for (float& value : light) value = static_cast<float>(random.uniform(-1, 1));
  return light;
}

double residual(const std::vector<float>& a, const std::vector<float>& b, std::size_t i) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    sum += std::abs(double{a[c * kCount + i]} - double{b[c * kCount + i]});
  }
  return sum;
}

TEST(ShBandPolicy, SpendsItsBudgetOnDifferentCoefficientsThatAreWrong) {
  ShBandPolicy policy(kDegree);
  for (const std::size_t budget : {0u, 1u, 7u, 25u, 48u, 49u, 1000u}) {
    const auto target = random_light(budget), held = random_light(budget + 1);
    const auto chosen = policy.choose(target, held, budget);
    EXPECT_EQ(chosen.size(), std::min<std::size_t>(budget, kCount));
    EXPECT_TRUE(std::ranges::is_sorted(chosen));
    EXPECT_EQ(std::set<std::uint32_t>(chosen.begin(), chosen.end()).size(), chosen.size());
  }
}

TEST(ShBandPolicy, LeavesAloneWhatIsRight) {
  ShBandPolicy policy(kDegree);
  const auto target = random_light(1);
  EXPECT_TRUE(policy.choose(target, target, 30).empty());
  auto held = target;
  held[kCount + 20] += 1;  // one channel
  held[2 * kCount + 33] += 0x1p-20f;
  EXPECT_THAT(policy.choose(target, held, 30), testing::ElementsAre(20u, 33u));
}

/// Figure 8.1 as it must be meant, written down plainly.
std::set<std::uint32_t> choose_plainly(const std::vector<float>& target,
                                       const std::vector<float>& held, std::size_t budget) {
  double whole = 0;
  for (const float value : target) whole += std::abs(double{value});
  std::set<std::uint32_t> chosen;
  double tolerance = 5e-4;
  int band = 0;
  while (chosen.size() < budget) {
    double error = 0;
    std::uint32_t largest = 0;
    double size = -1;
    for (std::size_t i = static_cast<std::size_t>(band * band); i < sh::coefficient_count(band);
         ++i) {
      const auto index = static_cast<std::uint32_t>(i);
      if (chosen.contains(index)) continue;
      error += residual(target, held, i);
      if (residual(target, held, i) > size) {
        size = residual(target, held, i);
        largest = index;
      }
    }
    if (size > 0 && error > tolerance * whole) {
      chosen.insert(largest);
    } else if (++band > kDegree) {
      band = 0;
      tolerance *= 0.1;
    }
  }
  return chosen;
}

TEST(ShBandPolicy, IsThePapersLoopWithErrorsThatFall) {
  ShBandPolicy policy(kDegree);
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const auto target = random_light(seed);
    auto held = target;
    Random random(seed, 9);
    // Errors of all sizes, so that the tolerance has to fall.
    for (float& value : held) {
      value += static_cast<float>(random.uniform(-1, 1) * std::pow(10, -6 * random.uniform()));
    }
    const std::size_t budget = 1 + random.below(kCount);
    const auto chosen = policy.choose(target, held, budget);
    EXPECT_EQ(std::set<std::uint32_t>(chosen.begin(), chosen.end()),
              choose_plainly(target, held, budget))
        << "seed " << seed;
  }
}

TEST(ShBandPolicy, RefusesWhatDoesNotFit) {
  ShBandPolicy policy(2);
  const std::vector<float> light(27), wrong(12);
  EXPECT_THROW(policy.choose(light, wrong, 3), CheckFailure);
  EXPECT_THROW(policy.choose(wrong, wrong, 3), CheckFailure);
  EXPECT_THROW(ShBandPolicy(-1), CheckFailure);
  EXPECT_THROW(ShBandPolicy(4, 0), CheckFailure);
}

}  // namespace
}  // namespace rimlight
