// What holds for every policy, frame after frame.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/math/random.h"
#include "core/relight/policy_settings.h"
#include "tests/support/allocation_count.h"
#include "tests/support/policy_case.h"
#include "tests/support/reference/policies.h"

namespace rimlight {
namespace {

using test::plan_of;
using test::PolicyCase;

class EveryPolicy : public ::testing::TestWithParam<std::string> {
 protected:
  PolicySettings settings_ = parse_policy(GetParam(), "test");
  std::unique_ptr<const UpdatePolicy> policy_ = make_policy(settings_);

  bool starts_afresh() const {
    return settings_.kind == PolicyKind::linear || settings_.kind == PolicyKind::nwa;
  }
};

/// Those that keep what the image shows.
class EveryIncrementalPolicy : public EveryPolicy {};
/// Those that order columns by what they find in them.
class EveryOrderingPolicy : public EveryPolicy {};

std::vector<std::string> policies_but(const std::vector<PolicyKind>& left_out) {
  std::vector<std::string> names = test::every_policy();
  std::erase_if(names, [&](const std::string& name) {
    return std::ranges::count(left_out, parse_policy(name, "test").kind) > 0;
  });
  return names;
}

std::string name_of(const ::testing::TestParamInfo<std::string>& instance) {
  std::string name = instance.param;
  std::ranges::replace(name, ':', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, EveryPolicy, ::testing::ValuesIn(test::every_policy()), name_of);
INSTANTIATE_TEST_SUITE_P(All, EveryIncrementalPolicy,
                         ::testing::ValuesIn(policies_but({PolicyKind::linear, PolicyKind::nwa})),
                         name_of);
INSTANTIATE_TEST_SUITE_P(All, EveryOrderingPolicy,
                         ::testing::ValuesIn(policies_but({PolicyKind::linear})), name_of);

TEST_P(EveryPolicy, KeepsItsBudgetToTheColumn) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const PolicyCase problem({.seed = seed, .quantum = 0, .zero_share = 0});
    for (const std::size_t amount : {0u, 1u, 9u, 60u, 383u, 384u, 500u}) {
      const UpdatePlan plan = plan_of(*policy_, problem.request(Budget::coefficients(amount)));
      // Bands that hold the target need no columns; everywhere else there is always one more.
      ASSERT_LE(plan.columns.size(), amount);
      if (starts_afresh()) {
        ASSERT_EQ(plan.columns.size(), std::min<std::size_t>(amount, 384));
      }
      if (amount <= 60) {
        ASSERT_EQ(plan.columns.size(), amount) << seed;
      }
    }
  }
}

TEST_P(EveryPolicy, KeepsABudgetInBytesAndUsesItUp) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    PolicyCase problem({.seed = seed, .quantum = 0});
    if (settings_.kind != PolicyKind::benefit) problem.image_bytes = 0;
    for (const std::size_t amount : {0u, 39u, 200u, 1500u}) {
      const PlanRequest request = problem.request(Budget::bytes(amount));
      const UpdatePlan plan = plan_of(*policy_, request);
      const auto choice =
          reference::choice_of(request, plan, reference::size_measure(request, Selection::area));
      const std::size_t cost = reference::cost_of(request, choice);
      ASSERT_LE(cost, amount) << seed;
      // The linear one leaves dark columns out, which it does not replace.
      if (settings_.kind != PolicyKind::linear) {
        ASSERT_GE(cost + 40, amount) << seed;
      }
    }
  }
}

TEST_P(EveryPolicy, TheFirstFrameResetsAllBands) {
  for (const Budget budget : {Budget::coefficients(30), Budget::bytes(400)}) {
    PolicyCase problem({.seed = 3});
    std::ranges::fill(problem.held.values, 0.0f);
    // A band that is to stay dark, too, and one that no receiver sees.
    for (int c = 0; c < 3; ++c) std::ranges::fill(problem.target.channel(c).subspan(24, 72), 0.0f);
    problem.leave_unseen(0, 24);
    const UpdatePlan plan = plan_of(*policy_, problem.request(budget));
    EXPECT_GT(plan.columns.size(), 10u);
    for (const BandUpdate& band : plan.bands) EXPECT_EQ(band.action, BandAction::reset);
  }
}

TEST_P(EveryIncrementalPolicy, StillLightConvergesToNoResidualAndThenHolds) {
  for (const Budget budget : {Budget::coefficients(20), Budget::bytes(400)}) {
    for (const std::size_t first_unseen : {96u, 150u, 384u}) {
      PolicyCase problem({.seed = 11, .quantum = 0});
      // What no receiver sees, here a band or most of it, is held in the end all the same.
      problem.leave_unseen(0, 24);
      problem.leave_unseen(first_unseen, 384);
      const PlanRequest request = problem.request(budget);
      // Whatever is reset at first, then 20 columns a frame, or the 10 or more of 400 bytes.
      for (int frame = 0; frame < 60; ++frame) {
        const UpdatePlan plan = plan_of(*policy_, request);
        test::apply(plan, problem.haar, problem.target, problem.held);
      }
      EXPECT_EQ(problem.held.values, problem.target.values);
      const UpdatePlan plan = plan_of(*policy_, request);
      EXPECT_TRUE(plan.columns.empty());
      for (const BandUpdate& band : plan.bands) EXPECT_EQ(band.action, BandAction::hold);
    }
  }
}

TEST_P(EveryOrderingPolicy, TheOrderOfColumnsInABandDoesNotMatter) {
  Random random(9);
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const PolicyCase problem({.seed = seed, .quantum = 0, .zero_share = 0});
    PolicyCase shuffled = problem;
    std::vector<std::size_t> place(problem.target.count());  // where each column goes
    std::iota(place.begin(), place.end(), std::size_t{0});
    for (int band = 0; band < problem.haar.band_count(); ++band) {
      const std::size_t begin = problem.haar.band_begin(band);
      for (std::size_t i = problem.haar.band_begin(band + 1); i-- > begin + 1;) {
        std::swap(place[i], place[begin + random.below(i + 1 - begin)]);
      }
    }
    const std::size_t count = place.size();
    for (std::size_t i = 0; i < count; ++i) {
      shuffled.bytes[place[i]] = problem.bytes[i];
      for (std::size_t c = 0; c < 3; ++c) {
        shuffled.target.values[c * count + place[i]] = problem.target.values[c * count + i];
        shuffled.held.values[c * count + place[i]] = problem.held.values[c * count + i];
        shuffled.norm_squared[c * count + place[i]] = problem.norm_squared[c * count + i];
      }
    }
    for (const Budget budget : {Budget::coefficients(30), Budget::bytes(500)}) {
      const UpdatePlan plan = plan_of(*policy_, problem.request(budget));
      const UpdatePlan moved = plan_of(*policy_, shuffled.request(budget));
      std::set<std::size_t> expected, found;
      for (const ColumnDelta& column : plan.columns) expected.insert(place[column.column]);
      for (const ColumnDelta& column : moved.columns) found.insert(column.column);
      ASSERT_EQ(found, expected);
      for (std::size_t b = 0; b < plan.bands.size(); ++b) {
        ASSERT_EQ(plan.bands[b].action, moved.bands[b].action);
      }
    }
  }
}

bool same(const UpdatePlan& a, const UpdatePlan& b) {
  return std::ranges::equal(a.bands, b.bands,
                            [](const auto& x, const auto& y) {
                              return x.action == y.action && x.first == y.first &&
                                     x.count == y.count;
                            }) &&
         std::ranges::equal(a.columns, b.columns, [](const auto& x, const auto& y) {
           return x.column == y.column && x.delta == y.delta;
         });
}

TEST_P(EveryPolicy, ReusedStorageChangesNothingAndIsNotAllocatedAgain) {
  PlanWorkspace workspace;
  UpdatePlan reused;
  // Another size first: what it leaves behind must not count.
  const PolicyCase other({.size = 16, .seed = 99});
  policy_->make_plan(other.request(Budget::coefficients(500)), workspace, reused);
  std::vector<PolicyCase> problems;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    problems.emplace_back(test::PolicyCaseSettings{.seed = seed});
  }
  std::size_t allocations = 0;
  for (const PolicyCase& problem : problems) {
    for (const Budget budget : {Budget::coefficients(25), Budget::coefficients(384),
                                Budget::bytes(300), Budget::bytes(100000)}) {
      const PlanRequest request = problem.request(budget);
      const std::size_t before = test::allocation_count();
      policy_->make_plan(request, workspace, reused);
      allocations += test::allocation_count() - before;
      ASSERT_TRUE(same(reused, plan_of(*policy_, request)));
    }
  }
  if (test::kCountsAllocations) {
    EXPECT_EQ(allocations, 0u);
  }
}

}  // namespace
}  // namespace rimlight
