#include "core/relight/policy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "core/math/random.h"

namespace rimlight {
namespace {

constexpr int kSize = 8;
const CubeHaar kHaar(kSize);

/// Coefficients that fall off with the band, some zero, some equal: `quantum` makes ties.
CubeLight random_light(std::uint64_t seed, float quantum = 0) {
  Random random(seed);
  CubeLight light(kSize);
  for (std::size_t i = 0; i < light.count(); ++i) {
    if (random.uniform() < 0.2) continue;
    const double size = 1.0 / (1 + kHaar.band_of(i));
    for (int c = 0; c < 3; ++c) {
      auto value = static_cast<float>(random.uniform(-size, size));
      if (quantum > 0) value = std::round(value / quantum) * quantum;
      light.channel(c)[i] = value;
    }
  }
  return light;
}

UpdatePlan plan_of(const UpdatePolicy& policy, const CubeLight& target, const CubeLight& held,
                   std::size_t budget) {
  PlanWorkspace workspace;
  UpdatePlan plan;
  policy.make_plan({kHaar, target, held, budget}, workspace, plan);
  return plan;
}

double l1(const CubeLight& a, const CubeLight* b, int band) {
  double sum = 0;
  for (std::size_t i = kHaar.band_begin(band); i < kHaar.band_begin(band + 1); ++i) {
    for (int c = 0; c < 3; ++c) {
      sum += std::abs(double{a.channel(c)[i]} - (b != nullptr ? double{b->channel(c)[i]} : 0));
    }
  }
  return sum;
}

/// The columns that a plan should have, by sorting everything.
std::vector<std::size_t> expected_columns(const CubeLight& target, const CubeLight& held,
                                          const std::vector<bool>& reset, std::size_t budget) {
  std::vector<std::tuple<float, std::size_t>> sizes;
  for (std::size_t i = 0; i < target.count(); ++i) {
    const int band = kHaar.band_of(i);
    const Vec3f delta =
        reset[static_cast<std::size_t>(band)] ? target.at(i) : target.at(i) - held.at(i);
    // N = 8: bands of 64, 16, 4 texels a wavelet, whose roots are 8, 4, 2.
    const float weight = static_cast<float>(8 >> band);
    const float size = weight * (std::abs(delta.x) + std::abs(delta.y) + std::abs(delta.z));
    if (size > 0) sizes.emplace_back(-size, i);
  }
  std::ranges::sort(sizes);
  std::vector<std::size_t> columns;
  for (std::size_t k = 0; k < std::min(budget, sizes.size()); ++k) {
    columns.push_back(std::get<1>(sizes[k]));
  }
  std::ranges::sort(columns);
  return columns;
}

void expect_plan(const UpdatePlan& plan, const CubeLight& target, const CubeLight& held,
                 const std::vector<bool>& reset, std::size_t budget) {
  const auto columns = expected_columns(target, held, reset, budget);
  ASSERT_EQ(plan.columns.size(), columns.size());
  ASSERT_EQ(plan.bands.size(), 3u);
  std::size_t next = 0;
  for (int band = 0; band < 3; ++band) {
    const BandUpdate& update = plan.bands[static_cast<std::size_t>(band)];
    const bool resets = reset[static_cast<std::size_t>(band)];
    ASSERT_EQ(update.first, next);
    ASSERT_EQ(update.action, resets             ? BandAction::reset
                             : update.count > 0 ? BandAction::increment
                                                : BandAction::hold);
    for (; next < update.first + update.count; ++next) {
      ASSERT_EQ(plan.columns[next].column, columns[next]);
      ASSERT_EQ(kHaar.band_of(columns[next]), band);
      const Vec3f target_value = target.at(columns[next]);
      ASSERT_EQ(plan.columns[next].delta,
                resets ? target_value : target_value - held.at(columns[next]));
    }
  }
  ASSERT_EQ(next, plan.columns.size());
}

const std::vector<std::size_t> kBudgets = {0, 1, 7, 30, 100, 383, 384, 100000};

TEST(NwaPolicy, ResetsAllBandsAndTakesTheLargestWeightedCoefficients) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const CubeLight target = random_light(seed), held = random_light(seed + 100);
    for (const std::size_t budget : kBudgets) {
      expect_plan(plan_of(NwaPolicy(), target, held, budget), target, held, {true, true, true},
                  budget);
    }
  }
}

TEST(PbiPolicy, ResetsTheBandsWhoseChangeIsNotSmallerThanTheTargetItself) {
  Random random(1);
  int resets = 0, increments = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const CubeLight target = random_light(seed);
    CubeLight held = random_light(seed + 100);
    // Each band's held light anywhere from near the target to far off.
    for (int band = 0; band < 3; ++band) {
      const auto near = static_cast<float>(random.uniform());
      for (std::size_t i = kHaar.band_begin(band); i < kHaar.band_begin(band + 1); ++i) {
        for (int c = 0; c < 3; ++c) {
          float& value = held.channel(c)[i];
          value = near * target.channel(c)[i] + (1 - near) * value;
        }
      }
    }
    std::vector<bool> reset;
    for (int band = 0; band < 3; ++band) {
      reset.push_back(!(l1(target, &held, band) < l1(target, nullptr, band)));
      (reset.back() ? resets : increments)++;
    }
    for (const std::size_t budget : kBudgets) {
      expect_plan(plan_of(PbiPolicy(), target, held, budget), target, held, reset, budget);
    }
  }
  EXPECT_GT(resets, 20);
  EXPECT_GT(increments, 20);
}

TEST(PbiPolicy, TheFirstFrameResetsAllBands) {
  const CubeLight target = random_light(3), black(kSize);
  expect_plan(plan_of(PbiPolicy(), target, black, 30), target, black, {true, true, true}, 30);
}

TEST(PbiPolicy, WithNothingToDoHolds) {
  const CubeLight target = random_light(3);
  const UpdatePlan plan = plan_of(PbiPolicy(), target, target, 30);
  EXPECT_TRUE(plan.columns.empty());
  for (const BandUpdate& update : plan.bands) EXPECT_EQ(update.action, BandAction::hold);
}

TEST(PbiPolicy, ADarkTargetResetsWithoutColumns) {
  const CubeLight held = random_light(3), black(kSize);
  const UpdatePlan plan = plan_of(PbiPolicy(), black, held, 30);
  EXPECT_TRUE(plan.columns.empty());
  for (const BandUpdate& update : plan.bands) EXPECT_EQ(update.action, BandAction::reset);
}

TEST(UpdatePolicy, EqualSizesGoToTheLowerIndex) {
  int ties = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const CubeLight target = random_light(seed, 0.25f), held = random_light(seed + 50, 0.25f);
    for (const std::size_t budget : {5u, 20u, 60u}) {
      expect_plan(plan_of(NwaPolicy(), target, held, budget), target, held, {true, true, true},
                  budget);
      const auto more = expected_columns(target, held, {true, true, true}, budget + 1);
      const auto fewer = expected_columns(target, held, {true, true, true}, budget);
      std::vector<std::size_t> last;
      std::ranges::set_difference(more, fewer, std::back_inserter(last));
      const auto weighted = [&](std::size_t i) {
        const Vec3f v = target.at(i);
        return static_cast<float>(8 >> kHaar.band_of(i)) *
               (std::abs(v.x) + std::abs(v.y) + std::abs(v.z));
      };
      ties += std::ranges::any_of(fewer,
                                  [&](std::size_t i) { return weighted(i) == weighted(last[0]); });
    }
  }
  EXPECT_GT(ties, 30) << "the cut has to fall between equals";
}

TEST(UpdatePolicy, ReusedStorageChangesNothing) {
  PlanWorkspace workspace;
  UpdatePlan reused;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const CubeLight target = random_light(seed), held = random_light(seed + 1);
    PbiPolicy().make_plan({kHaar, target, held, 10 * seed}, workspace, reused);
    const UpdatePlan fresh = plan_of(PbiPolicy(), target, held, 10 * seed);
    ASSERT_EQ(reused.columns.size(), fresh.columns.size());
    for (std::size_t i = 0; i < fresh.columns.size(); ++i) {
      ASSERT_EQ(reused.columns[i].column, fresh.columns[i].column);
      ASSERT_EQ(reused.columns[i].delta, fresh.columns[i].delta);
    }
  }
}

/// What the weight means: the L1 norm, over the texels, of a coefficient's term of the light.
TEST(AreaWeight, IsTheL1NormOfAUnitCoefficientOverTheCubeMap) {
  for (std::size_t i = 0; i < kHaar.coefficient_count(); i += 5) {
    std::vector<float> coefficients(kHaar.coefficient_count()), texels(kHaar.coefficient_count());
    coefficients[i] = 1;
    kHaar.inverse(coefficients, texels);
    double norm = 0;
    for (const float texel : texels) norm += std::abs(texel);
    EXPECT_NEAR(area_weight(kHaar, kHaar.band_of(i)), norm, 1e-5) << i;
  }
}

TEST(WeightedDistance, IsTheSumOfTheTermsL1Norms) {
  const CubeLight a = random_light(1), b = random_light(2);
  double expected = 0;
  for (int band = 0; band < 3; ++band) expected += (8 >> band) * l1(a, &b, band);
  EXPECT_NEAR(weighted_distance(kHaar, a, b), expected, 1e-12 * expected);
  EXPECT_NEAR(weighted_size(kHaar, a), weighted_distance(kHaar, a, CubeLight(kSize)), 1e-9);
  EXPECT_EQ(weighted_distance(kHaar, a, a), 0);
}

}  // namespace
}  // namespace rimlight
