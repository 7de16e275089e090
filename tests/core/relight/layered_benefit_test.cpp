#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/math/random.h"
#include "core/relight/held_light.h"
#include "tests/support/policy_case.h"

namespace rimlight {
namespace {

using test::PolicyCase;
using test::PolicyCaseSettings;

/// A random problem whose layers show different lights, cost and weigh by themselves; whole columns
/// cost and weigh what their layers do.
struct LayeredCase {
  PolicyCase problem;
  std::array<CubeLight, kLayers> held;
  std::vector<float> part_norm_squared;
  std::vector<std::uint32_t> part_bytes;

  explicit LayeredCase(const PolicyCaseSettings& settings) : problem(settings) {
    Random random(settings.seed, 77);
    const std::size_t columns = problem.haar.coefficient_count(), parts = columns * kLayers;
    held.fill(problem.held);
    part_norm_squared.resize(3 * parts);
    part_bytes.resize(parts);
    for (std::size_t i = 0; i < columns; ++i) {
      problem.bytes[i] = 0;
      for (std::size_t layer = 0; layer < kLayers; ++layer) {
        const bool there = problem.target.at(i) != Vec3f{} && random.below(3) == 0;
        for (int c = 0; c < 3 && there; ++c) {
          held[layer].channel(c)[i] = problem.target.channel(c)[i];
        }
        part_bytes[part_of(i, layer)] = static_cast<std::uint32_t>(1 + random.below(20));
        problem.bytes[i] += part_bytes[part_of(i, layer)];
        for (std::size_t c = 0; c < 3; ++c) {
          // As in a bake: the cheap first layer has nearly all of it.
          constexpr std::array<float, kLayers> kShares = {0.75f, 0.1875f, 0.0625f};
          part_norm_squared[c * parts + part_of(i, layer)] =
              kShares[layer] * problem.norm_squared[c * columns + i];
        }
      }
    }
  }

  PlanRequest request(std::size_t budget) const {
    PlanRequest result = problem.request(Budget::bytes(budget));
    result.held = HeldLight(held);
    result.part_norm_squared = part_norm_squared;
    result.part_bytes = part_bytes;
    return result;
  }

  double energy(std::size_t part, const Vec3f& delta) const {
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
      sum += double{part_norm_squared[static_cast<std::size_t>(c) * part_bytes.size() + part]} *
             double{delta[c]} * double{delta[c]};
    }
    return sum;
  }

  Vec3f delta(std::size_t part, bool reset) const {
    const Vec3f target = problem.target.at(part / kLayers);
    return reset ? target : target - held[part % kLayers].at(part / kLayers);
  }

  bool holds_something(int band) const {
    for (std::size_t i = problem.haar.band_begin(band); i < problem.haar.band_begin(band + 1);
         ++i) {
      for (const CubeLight& layer : held) {
        if (layer.at(i) != Vec3f{}) return true;
      }
    }
    return false;
  }
};

/// What a plan costs and leaves; checks that it is one.
struct Outcome {
  double error = 0;
  std::size_t cost = 0;
};

Outcome outcome_of(const LayeredCase& layered, const UpdatePlan& plan) {
  const CubeHaar& haar = layered.problem.haar;
  Outcome outcome;
  std::vector<bool> applied(layered.part_bytes.size()), reset(plan.bands.size());
  for (std::size_t b = 0; b < plan.bands.size(); ++b) {
    const BandUpdate& band = plan.bands[b];
    reset[b] = band.action == BandAction::reset;
    if (reset[b] && band.count > 0 && layered.holds_something(static_cast<int>(b))) {
      outcome.cost += layered.problem.image_bytes;
    }
    for (std::size_t k = band.first; k < band.first + band.count; ++k) {
      const ColumnDelta& column = plan.columns[k];
      EXPECT_EQ(haar.band_of(column.column), static_cast<int>(b));
      EXPECT_TRUE(k == 0 || plan.columns[k - 1].column <= column.column);
      EXPECT_NE(column.delta, Vec3f{});
      EXPECT_NE(column.layers, 0);
      for (std::size_t layer = 0; layer < kLayers; ++layer) {
        if ((column.layers >> layer & 1) == 0) continue;
        const std::size_t part = part_of(column.column, layer);
        EXPECT_FALSE(applied[part]) << "twice";
        applied[part] = true;
        outcome.cost += layered.part_bytes[part];
        EXPECT_EQ(column.delta, layered.delta(part, reset[b]));
      }
    }
  }
  for (std::size_t part = 0; part < applied.size(); ++part) {
    if (applied[part]) continue;
    const auto band = static_cast<std::size_t>(haar.band_of(part / kLayers));
    outcome.error += layered.energy(part, layered.delta(part, reset[band]));
  }
  return outcome;
}

/// The most that one part may mend.
double largest_benefit(const LayeredCase& layered) {
  double most = 0;
  for (std::size_t part = 0; part < layered.part_bytes.size(); ++part) {
    for (const bool reset : {false, true}) {
      most = std::max(most, layered.energy(part, layered.delta(part, reset)));
    }
  }
  return most;
}

/// The least error of all sets of resets and of parts, for a few active columns.
double least_error(const LayeredCase& layered, std::size_t budget) {
  const CubeHaar& haar = layered.problem.haar;
  std::vector<std::size_t> active;
  for (std::size_t part = 0; part < layered.part_bytes.size(); ++part) {
    if (layered.energy(part, layered.delta(part, false)) > 0 ||
        layered.energy(part, layered.delta(part, true)) > 0) {
      active.push_back(part);
    }
  }
  double least = std::numeric_limits<double>::infinity();
  for (unsigned resets = 0; resets < 1u << haar.band_count(); ++resets) {
    for (unsigned set = 0; set < 1u << active.size(); ++set) {
      double error = 0;
      std::size_t cost = 0;
      unsigned filled = 0;
      for (std::size_t k = 0; k < active.size(); ++k) {
        const int band = haar.band_of(active[k] / kLayers);
        if ((set >> k & 1) != 0) {
          cost += layered.part_bytes[active[k]];
          filled |= 1u << band;
        } else {
          error += layered.energy(active[k], layered.delta(active[k], (resets >> band & 1) != 0));
        }
      }
      for (int band = 0; band < haar.band_count(); ++band) {
        const bool cleared = ((resets & filled) >> band & 1) != 0 && layered.holds_something(band);
        cost += cleared ? layered.problem.image_bytes : 0;
      }
      if (cost <= budget) least = std::min(least, error);
    }
  }
  return least;
}

TEST(LayeredBenefit, ItsErrorIsTheLeastThereIsUpToOnePart) {
  double worst = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const LayeredCase layered({.size = 4, .seed = seed, .active_columns = 4});
    for (const std::size_t budget : {0u, 8u, 25u, 60u, 150u, 100000u}) {
      const Outcome found = outcome_of(layered, test::plan_of("benefit", layered.request(budget)));
      ASSERT_LE(found.cost, budget);
      const double least = least_error(layered, budget), one = largest_benefit(layered);
      ASSERT_LE(found.error, least + one) << seed << " " << budget;
      worst = std::max(worst, one > 0 ? (found.error - least) / one : 0);
      if (budget == 100000) {
        ASSERT_EQ(found.error, 0);
      }
    }
  }
  RecordProperty("worst_excess_in_parts", std::to_string(worst));
}

TEST(LayeredBenefit, LeavesLessThanWholeColumnsForTheSameBytes) {
  double sum = 0;
  int count = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    LayeredCase layered({.seed = seed, .quantum = 0});
    layered.held.fill(layered.problem.held);  // whole columns show one light
    for (const std::size_t budget : {300u, 1000u, 3000u}) {
      const Outcome by_parts =
          outcome_of(layered, test::plan_of("benefit", layered.request(budget)));
      PlanRequest whole = layered.request(budget);
      whole.part_bytes = {};
      const Outcome by_columns = outcome_of(layered, test::plan_of("benefit", whole));
      ASSERT_LE(by_columns.cost, budget);
      ASSERT_LE(by_parts.error, by_columns.error + largest_benefit(layered));
      if (by_columns.error == 0) continue;  // all of it fits
      sum += by_parts.error / by_columns.error;
      ++count;
    }
  }
  EXPECT_GT(count, 40);
  EXPECT_LT(sum / count, 0.8);
}

/// With one image for all bands, a plan increments all or resets all, whichever leaves less.
TEST(LayeredBenefit, BandsHeldTogetherAreResetTogetherWhereItPays) {
  int resets = 0, increments = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    LayeredCase layered({.size = 4, .seed = seed, .active_columns = 4});
    if (seed % 2 == 0) {  // an image all wrong: to clear it mends a lot
      for (CubeLight& layer : layered.held) {
        for (float& value : layer.values) value *= -8;
      }
    }
    for (const std::size_t budget : {0u, 8u, 25u, 60u, 150u, 100000u}) {
      PlanRequest request = layered.request(budget);
      request.one_image = true;
      const UpdatePlan plan = test::plan_of("benefit", request);
      const auto reset = std::ranges::count(plan.bands, BandAction::reset, &BandUpdate::action);
      ASSERT_TRUE(reset == 0 || reset == static_cast<long>(plan.bands.size()));
      (reset > 0 ? resets : increments) += 1;
      std::size_t parts = 0;
      for (const ColumnDelta& column : plan.columns) {
        for (std::size_t layer = 0; layer < kLayers; ++layer) {
          if ((column.layers >> layer & 1) == 0) continue;
          parts += layered.part_bytes[part_of(column.column, layer)];
        }
      }
      ASSERT_LE(parts + (reset > 0 ? layered.problem.image_bytes : 0), budget);
      // Not above what doing nothing leaves.
      UpdatePlan nothing;
      nothing.bands.resize(plan.bands.size());
      ASSERT_LE(outcome_of(layered, plan).error, outcome_of(layered, nothing).error);
    }
  }
  EXPECT_GT(resets, 5);
  EXPECT_GT(increments, 20);
}

TEST(LayeredBenefit, LayersWithOneDeltaGoTogether) {
  LayeredCase layered({.seed = 3, .zero_share = 0});
  layered.held.fill(layered.problem.held);
  const UpdatePlan plan = test::plan_of("benefit", layered.request(1'000'000));
  std::set<std::uint32_t> columns;
  for (const ColumnDelta& column : plan.columns) {
    EXPECT_EQ(column.layers, kAllLayers);
    EXPECT_TRUE(columns.insert(column.column).second);
  }
  EXPECT_EQ(plan.column_count(), columns.size());
  EXPECT_GT(columns.size(), 300u);
}

TEST(LayeredBenefit, ABudgetOfCoefficientsTakesWholeColumns) {
  LayeredCase layered({.seed = 4});
  layered.held.fill(layered.problem.held);
  PlanRequest request = layered.request(0);
  request.budget = Budget::coefficients(17);
  const UpdatePlan plan = test::plan_of("benefit", request);
  EXPECT_EQ(plan.columns.size(), 17u);
  for (const ColumnDelta& column : plan.columns) EXPECT_EQ(column.layers, kAllLayers);
}

TEST(AppendDeltas, GroupsWhatIsTheSameAndLeavesOutZeros) {
  std::vector<ColumnDelta> columns;
  const Vec3f a{1, 2, 3}, b{1, 2, 4};
  append_deltas(7, {a, b, a}, kAllLayers, columns);
  append_deltas(8, {Vec3f{}, b, b}, kAllLayers, columns);
  append_deltas(9, {a, a, a}, 0b110, columns);
  append_deltas(10, {Vec3f{}, Vec3f{}, Vec3f{}}, kAllLayers, columns);
  ASSERT_EQ(columns.size(), 4u);
  const auto expect = [&](std::size_t at, std::uint32_t column, const Vec3f& delta, int layers) {
    EXPECT_EQ(columns[at].column, column);
    EXPECT_EQ(columns[at].delta, delta);
    EXPECT_EQ(columns[at].layers, layers);
  };
  expect(0, 7, a, 0b101);
  expect(1, 7, b, 0b010);
  expect(2, 8, b, 0b110);
  expect(3, 9, a, 0b110);
}

TEST(HeldLight, ItsMeanIsWeighedBySharesOfEnergy) {
  std::array<CubeLight, kLayers> layers;
  for (std::size_t i = 0; i < kLayers; ++i) {
    layers[i] = CubeLight(2);
    std::ranges::fill(layers[i].values, static_cast<float>(i + 1));
  }
  CubeLight mean;
  find_mean(layers, {0.5f, 0.25f, 0.25f}, mean);
  for (const float value : mean.values) EXPECT_FLOAT_EQ(value, 1.75f);
  find_mean(layers[1], {0.3f, 0.3f, 0.4f}, mean);
  EXPECT_EQ(mean.values, layers[1].values);

  Sketch sketch;
  sketch.part_norm_squared = {3, 1, 0, 1, 2, 1};
  const auto shares = layer_shares(sketch);
  EXPECT_FLOAT_EQ(shares[0], 0.5f);
  EXPECT_FLOAT_EQ(shares[1], 0.375f);
  EXPECT_FLOAT_EQ(shares[2], 0.125f);
}

}  // namespace
}  // namespace rimlight
