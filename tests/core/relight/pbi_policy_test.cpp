// The dealer and the exhaustive band test against references that compute each step afresh.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/relight/policy_settings.h"
#include "tests/support/policy_case.h"
#include "tests/support/reference/policies.h"

namespace rimlight {
namespace {

using reference::Choice;
using reference::choice_of;
using test::plan_of;
using test::PolicyCase;

const std::vector<std::pair<std::string, Selection>> kSelections = {
    {"unweighted", Selection::unweighted},
    {"area", Selection::area},
    {"transport", Selection::transport}};

void expect_choice(const Choice& found, const Choice& expected) {
  ASSERT_EQ(found.reset, expected.reset);
  ASSERT_EQ(found.columns, expected.columns);
  ASSERT_EQ(found.error, expected.error);
}

TEST(PbiPolicy, TheExhaustiveTestIsTheBestOfAllCombinations) {
  int mixed = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const PolicyCase problem({.seed = seed, .quantum = seed % 2 == 0 ? 0.25f : 1.0f / 16});
    for (const std::size_t budget : {0u, 1u, 5u, 40u, 200u, 384u}) {
      const PlanRequest request = problem.request(Budget::coefficients(budget));
      for (const auto& [name, selection] : kSelections) {
        const auto measure = reference::size_measure(request, selection);
        const Choice found =
            choice_of(request, plan_of(("pbi:exhaustive:" + name).c_str(), request), measure);
        ASSERT_NO_FATAL_FAILURE(expect_choice(found, reference::exhaustive(request, measure)))
            << seed << " " << budget << " " << name;
        mixed += found.reset[0] != found.reset[1] || found.reset[1] != found.reset[2];
      }
    }
  }
  EXPECT_GT(mixed, 100);
}

TEST(PbiPolicy, TheDealerDealsEachColumnWhereTheErrorFallsMost) {
  int mixed = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const PolicyCase problem({.seed = seed, .quantum = seed % 2 == 0 ? 0.25f : 1.0f / 16});
    for (const std::size_t budget : {0u, 1u, 5u, 40u, 90u}) {
      const PlanRequest request = problem.request(Budget::coefficients(budget));
      const auto& [name, selection] = kSelections[(seed + budget) % 3];
      const auto measure = reference::size_measure(request, selection);
      const Choice found =
          choice_of(request, plan_of(("pbi:dealer:" + name).c_str(), request), measure);
      ASSERT_NO_FATAL_FAILURE(expect_choice(found, reference::dealer(request, measure)))
          << seed << " " << budget << " " << name;
      mixed += found.reset[0] != found.reset[1] || found.reset[1] != found.reset[2];
    }
  }
  EXPECT_GT(mixed, 10);
}

/// In the measure of the selection, for coefficients. The dealer may be worse than the simple test.
TEST(PbiPolicy, NoPolicyOfThePaperLeavesLessErrorInAFrameThanTheExhaustiveTest) {
  int better_than_simple = 0, better_than_dealer = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const PolicyCase problem({.size = 16, .seed = seed, .quantum = 0});
    for (const std::size_t budget : {3u, 30u, 300u}) {
      const PlanRequest request = problem.request(Budget::coefficients(budget));
      for (const auto& named : kSelections) {
        const std::string& name = named.first;
        const auto measure = reference::size_measure(request, named.second);
        const auto error = [&](const std::string& policy) {
          return choice_of(request, plan_of((policy + name).c_str(), request), measure).error;
        };
        const double least = error("pbi:exhaustive:");
        for (const char* const other : {"pbi:simple:", "pbi:dealer:", "bi:", "nwa:"}) {
          ASSERT_LE(least, error(other) * (1 + 1e-6)) << other << name << " " << seed;
        }
        better_than_simple += least < 0.999 * error("pbi:simple:");
        better_than_dealer += least < 0.999 * error("pbi:dealer:");
      }
    }
  }
  EXPECT_GT(better_than_simple, 5);
  EXPECT_GT(better_than_dealer, 5);
}

/// By transport, a band that no receiver sees in its changed columns has nothing to reset for.
TEST(PbiPolicy, TheSimpleTestMeasuresAsTheSelectionDoes) {
  PolicyCase problem({.seed = 4});
  for (std::size_t i = 0; i < problem.target.count(); ++i) {
    const bool odd = i % 2 != 0;  // odd columns are far off, even ones right
    for (int c = 0; c < 3; ++c) {
      problem.target.channel(c)[i] = 0.5f;
      problem.held.channel(c)[i] = odd ? -2.0f : 0.5f;
      problem.norm_squared[static_cast<std::size_t>(c) * problem.target.count() + i] = odd ? 0 : 1;
    }
  }
  const PlanRequest request = problem.request(Budget::coefficients(10));
  for (const BandUpdate& band : plan_of("pbi:area", request).bands) {
    EXPECT_EQ(band.action, BandAction::reset);
  }
  for (const BandUpdate& band : plan_of("pbi:transport", request).bands) {
    EXPECT_NE(band.action, BandAction::reset);
  }
}

}  // namespace
}  // namespace rimlight
