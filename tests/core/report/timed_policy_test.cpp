#include "core/report/timed_policy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/error_of.h"

namespace rimlight {
namespace {

using ::testing::HasSubstr;

TEST(TimedPolicy, NamesReadBackAsWhatTheyName) {
  for (const char* const text :
       {"nwa@30", "pbi:dealer:transport@2MB", "benefit@16ms", "benefit@pbi@30",
        "benefit@bytes:pbi@30", "bi:unweighted@nwa@100"}) {
    EXPECT_EQ(parse_timed_policy(text, "x").name(), text);
  }
  EXPECT_EQ(parse_timed_policy("benefit@pbi@30", "x").other, "pbi@30");
  EXPECT_EQ(parse_timed_policy("benefit@pbi@30", "x").budget.unit, FrameBudget::Unit::milliseconds);
  EXPECT_EQ(parse_timed_policy("benefit@bytes:pbi@30", "x").budget.unit, FrameBudget::Unit::bytes);
  EXPECT_EQ(parse_timed_policy("pbi@30", "x").budget.amount, 30);
}

TEST(TimedPolicy, WhatIsNoneIsRefusedByName) {
  for (const char* const text :
       {"", "pbi", "@30", "pbi@", "pbi@30 ", "pbi@-1", "paint@30", "benefit@pbi",
        "benefit@pbi@nwa@30", "benefit@bytes:30", "bytes:pbi@30", "benefit@@30"}) {
    const std::string error = test::error_of([&] { return parse_timed_policy(text, "--policy"); });
    EXPECT_THAT(error, HasSubstr("--policy: found")) << text;
  }
}

TEST(TimedPolicy, TheDefaultsComeAfterThoseWhoseTimeTheyTake) {
  std::vector<std::string> names;
  for (const TimedPolicy& policy : default_timed_policies()) {
    if (!policy.other.empty()) {
      EXPECT_THAT(names, ::testing::Contains(policy.other));
    }
    EXPECT_THAT(names, ::testing::Not(::testing::Contains(policy.name())));
    names.push_back(policy.name());
  }
  EXPECT_THAT(names, ::testing::IsSupersetOf({"nwa@500", "bi@30", "pbi@30", "benefit@16ms"}));
}

}  // namespace
}  // namespace rimlight
