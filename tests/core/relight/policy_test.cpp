#include "core/relight/policy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/relight/policy_settings.h"
#include "tests/support/error_of.h"
#include "tests/support/policy_case.h"
#include "tests/support/reference/policies.h"

namespace rimlight {
namespace {

using test::plan_of;
using test::PolicyCase;

const std::vector<std::size_t> kBudgets = {0, 1, 7, 30, 100, 383, 384, 100000};
const std::vector<std::pair<std::string, Selection>> kSelections = {
    {"unweighted", Selection::unweighted},
    {"area", Selection::area},
    {"transport", Selection::transport}};

PlanRequest with(const PolicyCase& problem, std::size_t coefficients) {
  return problem.request(Budget::coefficients(coefficients));
}

/// That the plan treats the bands and applies the columns of the choice, with their deltas.
void expect_plan(const UpdatePlan& plan, const PlanRequest& request,
                 const reference::Choice& expected) {
  ASSERT_EQ(plan.columns.size(), expected.columns.size());
  ASSERT_EQ(plan.bands.size(), expected.reset.size());
  std::size_t next = 0;
  for (std::size_t band = 0; band < plan.bands.size(); ++band) {
    const BandUpdate& update = plan.bands[band];
    ASSERT_EQ(update.first, next);
    ASSERT_EQ(update.action, expected.reset[band] ? BandAction::reset
                             : update.count > 0   ? BandAction::increment
                                                  : BandAction::hold);
    for (; next < update.first + update.count; ++next) {
      const std::size_t column = plan.columns[next].column;
      ASSERT_EQ(column, expected.columns[next]);
      ASSERT_EQ(request.basis.band_of(column), static_cast<int>(band));
      const Vec3f target = request.target.at(column);
      ASSERT_EQ(plan.columns[next].delta,
                expected.reset[band] ? target : target - request.held.layer(0).at(column));
    }
  }
  ASSERT_EQ(next, plan.columns.size());
}

double l1(const PlanRequest& request, const CubeLight* from, int band) {
  double sum = 0;
  for (std::size_t i = request.basis.band_begin(band); i < request.basis.band_begin(band + 1);
       ++i) {
    for (int c = 0; c < 3; ++c) {
      sum += std::abs(double{request.target.channel(c)[i]} -
                      (from != nullptr ? double{from->channel(c)[i]} : 0));
    }
  }
  return sum;
}

TEST(LinearPolicy, AppliesTheFirstColumnsAfresh) {
  const PolicyCase problem({.seed = 5});
  for (const std::size_t budget : kBudgets) {
    const PlanRequest request = with(problem, budget);
    reference::Choice expected{{true, true, true}, {}, 0};
    for (std::size_t i = 0; i < std::min<std::size_t>(budget, 384); ++i) {
      if (problem.target.at(i) != Vec3f{}) expected.columns.push_back(i);
    }
    expect_plan(plan_of("linear", request), request, expected);
  }
}

TEST(LinearPolicy, InBytesEndsAtTheFirstColumnThatDoesNotFit) {
  PolicyCase problem({.seed = 5, .zero_share = 0});
  problem.bytes[7] = 1000;
  problem.bytes[8] = 1;
  const UpdatePlan plan = plan_of("linear", problem.request(Budget::bytes(900)));
  EXPECT_EQ(plan.columns.size(), 7u);
}

TEST(NwaPolicy, ResetsAllBandsAndTakesTheLargestByWeight) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const PolicyCase problem({.seed = seed, .quantum = seed % 2 == 0 ? 0.25f : 1.0f / 64});
    for (const std::size_t budget : kBudgets) {
      const PlanRequest request = with(problem, budget);
      for (const auto& [name, selection] : kSelections) {
        const auto expected =
            best_columns(request, {true, true, true}, reference::size_measure(request, selection),
                         reference::Order::by_measure);
        expect_plan(plan_of(("nwa:" + name).c_str(), request), request, expected);
      }
    }
  }
}

TEST(BiPolicy, KeepsAllBandsAndTakesTheLargestDifferences) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const PolicyCase problem({.seed = seed});
    for (const std::size_t budget : kBudgets) {
      const PlanRequest request = with(problem, budget);
      for (const auto& [name, selection] : kSelections) {
        const auto expected =
            best_columns(request, {false, false, false},
                         reference::size_measure(request, selection), reference::Order::by_measure);
        expect_plan(plan_of(("bi:" + name).c_str(), request), request, expected);
      }
    }
  }
}

TEST(BiPolicy, WithoutALimitHoldsTheTargetAtOnce) {
  PolicyCase problem({.seed = 3, .quantum = 0});
  const PlanRequest request = with(problem, 384);
  test::apply(plan_of("bi", request), problem.haar, problem.target, problem.held);
  EXPECT_EQ(problem.held.values, problem.target.values);
}

TEST(PbiPolicy, TheSimpleTestResetsBandsWhoseChangeIsNotSmallerThanTheTarget) {
  int resets = 0, increments = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const PolicyCase problem({.seed = seed});
    std::vector<bool> reset;
    for (int band = 0; band < 3; ++band) {
      const PlanRequest any = with(problem, 1);
      reset.push_back(!(l1(any, &problem.held, band) < l1(any, nullptr, band)));
      (reset.back() ? resets : increments)++;
    }
    for (const std::size_t budget : kBudgets) {
      const PlanRequest request = with(problem, budget);
      for (const auto& [name, selection] : {kSelections[0], kSelections[1]}) {
        const auto expected =
            best_columns(request, reset, reference::size_measure(request, selection),
                         reference::Order::by_measure);
        expect_plan(plan_of(("pbi:" + name).c_str(), request), request, expected);
      }
    }
  }
  EXPECT_GT(resets, 20);
  EXPECT_GT(increments, 20);
}

TEST(UpdatePolicy, EqualSizesGoToTheLowerIndex) {
  int ties = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const PolicyCase problem({.seed = seed, .quantum = 0.25f});
    for (const std::size_t budget : {5u, 20u, 60u}) {
      const PlanRequest request = with(problem, budget), more = with(problem, budget + 1);
      const auto measure = reference::size_measure(request, Selection::area);
      const std::vector<bool> reset = {true, true, true};
      const auto fewer = best_columns(request, reset, measure, reference::Order::by_measure);
      const auto larger = best_columns(more, reset, measure, reference::Order::by_measure);
      expect_plan(plan_of("nwa", request), request, fewer);
      std::vector<std::size_t> last;
      std::ranges::set_difference(larger.columns, fewer.columns, std::back_inserter(last));
      const auto size = [&](std::size_t i) { return measure(i, Vec3d(problem.target.at(i))); };
      ties += std::ranges::any_of(fewer.columns,
                                  [&](std::size_t i) { return size(i) == size(last[0]); });
    }
  }
  EXPECT_GT(ties, 30) << "the cut has to fall between equals";
}

TEST(UpdatePolicy, SaysWhatARequestLacks) {
  const PolicyCase problem({});
  const PlanRequest bare{problem.haar, problem.target, problem.held, Budget::coefficients(9)};
  for (const char* const name : {"benefit", "nwa:transport", "bi:transport", "pbi:transport"}) {
    EXPECT_THAT(test::error_of([&] { plan_of(name, bare); }), ::testing::HasSubstr("no norms"));
  }
  EXPECT_NO_THROW(plan_of("pbi:exhaustive", bare));
  PlanRequest in_bytes = bare;
  in_bytes.budget = Budget::bytes(1000);
  EXPECT_THAT(test::error_of([&] { plan_of("pbi", in_bytes); }), ::testing::HasSubstr("no sizes"));
}

/// Nothing that a request may hold breaks the ranking.
TEST(UpdatePolicy, SurvivesHugeLightsAndBrokenNorms) {
  PolicyCase problem({.seed = 2, .quantum = 0});
  for (float& value : problem.target.values) value *= 3e38f;
  for (float& value : problem.held.values) value *= -3e38f;
  for (std::size_t i = 0; i < problem.norm_squared.size(); i += 3) {
    problem.norm_squared[i] = i % 2 == 0 ? -1.0f : std::nanf("");
  }
  for (const std::string& name : test::every_policy()) {
    const UpdatePlan plan = plan_of(name.c_str(), with(problem, 20));
    EXPECT_LE(plan.columns.size(), 20u) << name;
    EXPECT_GT(plan.columns.size(), 10u) << name;
  }
}

/// What the weight means: the L1 norm, over the texels, of a coefficient's term of the light.
TEST(AreaWeight, IsTheL1NormOfAUnitCoefficientOverTheCubeMap) {
  const CubeHaar haar(8);
  for (std::size_t i = 0; i < haar.coefficient_count(); i += 5) {
    std::vector<float> coefficients(haar.coefficient_count()), texels(haar.coefficient_count());
    coefficients[i] = 1;
    haar.inverse(coefficients, texels);
    double norm = 0;
    for (const float texel : texels) norm += std::abs(texel);
    EXPECT_NEAR(area_weight(haar, haar.band_of(i)), norm, 1e-5) << i;
  }
}

TEST(WeightedDistance, IsTheSumOfTheTermsL1Norms) {
  const PolicyCase problem({.quantum = 0});
  const PlanRequest request = with(problem, 0);
  double expected = 0;
  for (int band = 0; band < 3; ++band) expected += (8 >> band) * l1(request, &problem.held, band);
  EXPECT_NEAR(weighted_distance(problem.haar, problem.target, problem.held), expected,
              1e-12 * expected);
  EXPECT_NEAR(weighted_size(problem.haar, problem.target),
              weighted_distance(problem.haar, problem.target, CubeLight(8)), 1e-9);
  EXPECT_EQ(weighted_distance(problem.haar, problem.target, problem.target), 0);
}

}  // namespace
}  // namespace rimlight
