#include "core/relight/ranked_columns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>
#include <vector>

#include "tests/support/policy_case.h"

namespace rimlight {
namespace {

using test::PolicyCase;

/// All lists of a problem, ranked.
struct Ranked {
  PolicyCase problem;
  PlanRequest request;
  ColumnCosts costs;
  std::array<ColumnGains, 2> gains;
  RankedColumns columns;

  Ranked(const test::PolicyCaseSettings& settings, Budget budget)
      : problem(settings),
        request(problem.request(budget)),
        costs(request, Candidates::columns(problem.haar)) {
    for (const auto alternative : {Alternative::increment, Alternative::reset}) {
      measure_sizes(request, Selection::area, alternative,
                    gains[static_cast<std::size_t>(alternative)]);
    }
    for (int band = 0; band < problem.haar.band_count(); ++band) {
      for (const auto alternative : {Alternative::increment, Alternative::reset}) {
        columns.add(Candidates::columns(problem.haar), band, alternative,
                    gains[static_cast<std::size_t>(alternative)], costs);
      }
    }
    columns.sort();
  }
};

TEST(RankedColumns, EntriesComeByRankThenListThenIndex) {
  int ties = 0;
  for (const float quantum : {0.0f, 0.25f}) {
    const Ranked ranked({.size = 16, .quantum = quantum}, Budget::coefficients(2000));
    const auto entries = ranked.columns.entries();
    ASSERT_GT(entries.size(), 1000u);
    for (std::size_t i = 1; i < entries.size(); ++i) {
      const auto& a = entries[i - 1];
      const auto& b = entries[i];
      ASSERT_LT(std::tuple(-std::int64_t{a.rank()}, a.list(), a.column()),
                std::tuple(-std::int64_t{b.rank()}, b.list(), b.column()));
      ties += a.rank() == b.rank();
    }
  }
  EXPECT_GT(ties, 500);
}

/// What a list leaves out is worse than what it keeps, and what it keeps is worth the budget.
TEST(RankedColumns, EachListKeepsItsBestAsFarAsTheBudgetGoes) {
  int cut = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    for (const Budget budget : {Budget::coefficients(1), Budget::coefficients(60),
                                Budget::bytes(50), Budget::bytes(2000)}) {
      const Ranked ranked({.size = 16, .seed = seed, .quantum = 0}, budget);
      for (int list = 0; list < 2 * ranked.problem.haar.band_count(); ++list) {
        const ColumnGains& gains = ranked.gains[static_cast<std::size_t>(list % 2)];
        std::vector<std::size_t> kept;
        std::uint64_t cost = 0;
        for (const auto& entry : ranked.columns.entries()) {
          if (entry.list() != list) continue;
          kept.push_back(entry.column());
          cost += ranked.costs.of(entry.column());
          ASSERT_EQ(gains.rank[entry.column()], entry.rank());
        }
        std::ranges::sort(kept);
        std::uint32_t lowest_kept = UINT32_MAX, highest_left = 0;
        double left_out = 0;
        for (std::size_t i = ranked.problem.haar.band_begin(list / 2);
             i < ranked.problem.haar.band_begin(list / 2 + 1); ++i) {
          if (std::ranges::binary_search(kept, i)) {
            lowest_kept = std::min(lowest_kept, gains.rank[i]);
          } else {
            highest_left = std::max(highest_left, gains.rank[i]);
            left_out += double{gains.gain[i]};
          }
        }
        ASSERT_GT(lowest_kept, highest_left);
        if (highest_left > 0) {
          ASSERT_GE(cost, budget.amount);
          ++cut;
        }
        ASSERT_NEAR(
            ranked.columns.gains_left_out(Candidates::columns(ranked.problem.haar), list / 2,
                                          static_cast<Alternative>(list % 2), gains),
            left_out, 1e-9);
      }
    }
  }
  EXPECT_GT(cut, 100);
}

TEST(RankedColumns, ColumnsDearerThanTheWholeBudgetAreNoCandidates) {
  const Ranked ranked({.seed = 2}, Budget::bytes(20));
  ASSERT_FALSE(ranked.columns.entries().empty());
  for (const auto& entry : ranked.columns.entries()) {
    EXPECT_LE(ranked.problem.bytes[entry.column()], 20u);
  }
}

TEST(BudgetWalk, PassesOverWhatDoesNotFitButNotForEver) {
  BudgetWalk walk(10);
  EXPECT_TRUE(walk.takes(7));
  EXPECT_FALSE(walk.takes(4));
  EXPECT_TRUE(walk.takes(2));
  EXPECT_EQ(walk.left(), 1u);
  for (int i = 1; i < BudgetWalk::kMostPassedOver; ++i) {
    EXPECT_FALSE(walk.done());
    EXPECT_FALSE(walk.takes(2));
  }
  EXPECT_TRUE(walk.done());
}

}  // namespace
}  // namespace rimlight
