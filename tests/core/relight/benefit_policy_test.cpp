#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/relight/policy_settings.h"
#include "tests/support/policy_case.h"
#include "tests/support/reference/policies.h"

namespace rimlight {
namespace {

using reference::Choice;
using reference::choice_of;
using reference::Order;
using test::plan_of;
using test::PolicyCase;

Choice plan_choice(const PlanRequest& request) {
  return choice_of(request, plan_of("benefit", request), reference::energy_measure(request));
}

/// The largest benefit of any column that the budget could hold.
double largest_benefit(const PlanRequest& request) {
  const auto measure = reference::energy_measure(request);
  double most = 0;
  for (std::size_t i = 0; i < request.target.count(); ++i) {
    if (request.column_bytes[i] > request.budget.amount) continue;
    const Vec3d target(request.target.at(i));
    most = std::max(
        {most, measure(i, target), measure(i, target - Vec3d(request.held.layer(0).at(i)))});
  }
  return most;
}

/// What cannot be beaten is beaten: under every set of resets that is affordable, columns in order.
TEST(BenefitPolicy, IsTheBestOfAllSetsOfResets) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const PolicyCase problem({.seed = seed});
    for (const Budget budget :
         {Budget::coefficients(0), Budget::coefficients(17), Budget::coefficients(120),
          Budget::bytes(5), Budget::bytes(150), Budget::bytes(900), Budget::bytes(4000)}) {
      const PlanRequest request = problem.request(budget);
      const Choice found = plan_choice(request);
      ASSERT_LE(reference::cost_of(request, found), budget.amount);
      for (unsigned resets = 0; resets < 8; ++resets) {
        const std::vector<bool> reset = {(resets & 1) != 0, (resets & 2) != 0, (resets & 4) != 0};
        const Choice other =
            best_columns(request, reset, reference::energy_measure(request), Order::per_byte);
        if (reference::cost_of(request, other) > budget.amount) continue;
        ASSERT_LE(found.error, other.error) << seed << " " << budget.amount << " " << resets;
      }
    }
  }
}

TEST(BenefitPolicy, InCoefficientsItsErrorIsTheLeastThereIs) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const PolicyCase problem({.seed = seed, .active_columns = 11});
    for (const std::size_t budget : {0u, 2u, 5u, 11u}) {
      const PlanRequest request = problem.request(Budget::coefficients(budget));
      ASSERT_EQ(plan_choice(request).error,
                reference::least_error(request, reference::energy_measure(request)))
          << seed << " " << budget;
    }
  }
}

TEST(BenefitPolicy, InBytesItsErrorIsTheLeastThereIsUpToOneColumn) {
  double worst = 0;
  int resets = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const PolicyCase problem({.seed = seed, .active_columns = 10});
    for (const std::size_t budget : {10u, 45u, 90u, 200u, 100000u}) {
      const PlanRequest request = problem.request(Budget::bytes(budget));
      const double least = reference::least_error(request, reference::energy_measure(request));
      const Choice found = plan_choice(request);
      ASSERT_LE(found.error, least + largest_benefit(request)) << seed << " " << budget;
      if (budget == 100000) {
        ASSERT_EQ(found.error, 0);
      }
      worst = std::max(worst, (found.error - least) / largest_benefit(request));
      resets += std::ranges::count(found.reset, true) > 0;
    }
  }
  RecordProperty("worst_excess_in_columns", std::to_string(worst));
  EXPECT_GT(resets, 30);
}

/// A band whose held light is all wrong, and columns that would mend it one by one.
PolicyCase wrong_band() {
  PolicyCase problem({.seed = 1});
  std::ranges::fill(problem.target.values, 0.0f);
  std::ranges::fill(problem.held.values, 0.0f);
  std::ranges::fill(problem.norm_squared, 1.0f);
  std::ranges::fill(problem.bytes, 10u);
  for (std::size_t i = problem.haar.band_begin(2); i < problem.haar.band_begin(2) + 100; ++i) {
    problem.held.channel(0)[i] = 1;
    problem.target.channel(1)[i] = 0.25f;
  }
  return problem;
}

TEST(BenefitPolicy, ResetsWhereTheImageOfTheBandCostsLessThanItSaves) {
  PolicyCase problem = wrong_band();
  // Ten columns mend 10 · 1.0625; a reset mends 100 at once, and costs as much as nine of them.
  problem.image_bytes = 90;
  UpdatePlan plan = plan_of("benefit", problem.request(Budget::bytes(100)));
  EXPECT_EQ(plan.bands[2].action, BandAction::reset);
  EXPECT_EQ(plan.columns.size(), 1u);
  // A reset that the budget cannot hold beside a column still clears: that moves no byte.
  problem.image_bytes = 95;
  plan = plan_of("benefit", problem.request(Budget::bytes(100)));
  EXPECT_EQ(plan.bands[2].action, BandAction::reset);
  EXPECT_EQ(plan.columns.size(), 0u);
}

TEST(BenefitPolicy, IncrementsWhereAClearingWouldLoseMore) {
  PolicyCase problem = wrong_band();
  for (std::size_t i = problem.haar.band_begin(2); i < problem.haar.band_begin(3); ++i) {
    problem.held.channel(2)[i] = problem.target.channel(2)[i] = 2;  // right, and much
  }
  problem.image_bytes = 90;
  const UpdatePlan plan = plan_of("benefit", problem.request(Budget::bytes(100)));
  EXPECT_EQ(plan.bands[2].action, BandAction::increment);
  EXPECT_EQ(plan.columns.size(), 10u);
}

TEST(BenefitPolicy, ABandThatHoldsNothingIsResetForNothing) {
  PolicyCase problem({.seed = 6});
  std::ranges::fill(problem.held.values, 0.0f);
  problem.image_bytes = 1 << 20;
  const UpdatePlan plan = plan_of("benefit", problem.request(Budget::bytes(300)));
  for (const BandUpdate& band : plan.bands) EXPECT_EQ(band.action, BandAction::reset);
  EXPECT_GT(plan.columns.size(), 10u);
}

TEST(BenefitPolicy, ADarkTargetClearsAllBandsForNothing) {
  PolicyCase problem({.seed = 6});
  std::ranges::fill(problem.target.values, 0.0f);
  problem.image_bytes = 1 << 20;
  const UpdatePlan plan = plan_of("benefit", problem.request(Budget::bytes(1)));
  EXPECT_TRUE(plan.columns.empty());
  for (const BandUpdate& band : plan.bands) EXPECT_EQ(band.action, BandAction::reset);
}

TEST(BenefitPolicy, ColumnsThatNoReceiverSeesComeLast) {
  PolicyCase problem({.seed = 7, .zero_share = 0});
  const std::size_t count = problem.target.count();
  for (std::size_t i = 0; i < problem.norm_squared.size(); ++i) {
    problem.norm_squared[i] = i % count < 100 ? 0.0f : 1.0f;
  }
  std::ranges::fill(problem.held.values, 0.0f);
  const UpdatePlan seen = plan_of("benefit", problem.request(Budget::coefficients(count - 100)));
  ASSERT_EQ(seen.columns.size(), count - 100);
  EXPECT_EQ(seen.columns.front().column, 100u);
  const UpdatePlan all = plan_of("benefit", problem.request(Budget::coefficients(count)));
  EXPECT_EQ(all.columns.size(), count);
}

}  // namespace
}  // namespace rimlight
