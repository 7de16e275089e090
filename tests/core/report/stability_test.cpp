// The table of cases at the extremes: each holds, and each can fail.
#include "core/report/stability.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "core/base/error.h"
#include "core/report/report_files.h"
#include "tests/support/error_of.h"

namespace rimlight {
namespace {

std::vector<std::string> parts() {
  std::vector<std::string> names;
  for (const StabilityCase& one : stability_cases()) {
    if (names.empty() || names.back() != one.part) names.push_back(one.part);
  }
  return names;
}

/// The cases of one part, quickly; sound or disturbed.
std::vector<StabilityRow> run_part(const std::string& part, bool broken) {
  StabilitySettings settings;
  settings.parts = {part};
  settings.trial.fast = true;
  settings.trial.broken = broken;
  return measure_stability(settings, {});
}

class StabilityPart : public ::testing::TestWithParam<std::string> {};

TEST_P(StabilityPart, EveryCaseHolds) {
  const auto rows = run_part(GetParam(), false);
  ASSERT_FALSE(rows.empty());
  for (const StabilityRow& row : rows) {
    EXPECT_TRUE(row.pass) << row.of->name << ": " << row.of->quantity << " is "
                          << row.measured.value << ", bound " << row.of->bound << "; "
                          << row.measured.note;
    std::printf("%-30s %.3g of %.3g, %.2f s\n", row.of->name.c_str(), row.measured.value,
                row.of->bound, row.seconds);
  }
}

TEST_P(StabilityPart, EveryCaseFailsWhenItIsBroken) {
  const auto rows = run_part(GetParam(), true);
  ASSERT_FALSE(rows.empty());
  for (const StabilityRow& row : rows) {
    EXPECT_FALSE(row.pass) << row.of->name << " measures " << row.measured.value;
    EXPECT_FALSE(std::isnan(row.measured.value)) << row.of->name << ": " << row.measured.note;
  }
}

INSTANTIATE_TEST_SUITE_P(Each, StabilityPart, ::testing::ValuesIn(parts()),
                         [](const auto& part) { return part.param; });

TEST(Stability, NamesDifferAndEveryCaseSaysWhatHoldsAndWhy) {
  std::set<std::string> names;
  for (const StabilityCase& one : stability_cases()) {
    EXPECT_TRUE(names.insert(one.name).second) << one.name;
    EXPECT_FALSE(one.quantity.empty() || one.why.empty()) << one.name;
    EXPECT_TRUE(std::isfinite(one.bound)) << one.name;
  }
  EXPECT_GE(names.size(), 60u);
  EXPECT_EQ(parts().size(), 12u);
}

TEST(Stability, ABoundIsKeptToTheLastBitAndByNoNaN) {
  StabilityCase most{"a", "b", "c", BoundKind::at_most, 1, "d", {}};
  EXPECT_TRUE(keeps_bound(most, 1));
  EXPECT_FALSE(keeps_bound(most, std::nextafter(1.0, 2.0)));
  EXPECT_FALSE(keeps_bound(most, std::numeric_limits<double>::quiet_NaN()));
  most.kind = BoundKind::at_least;
  EXPECT_TRUE(keeps_bound(most, 1));
  EXPECT_FALSE(keeps_bound(most, std::nextafter(1.0, 0.0)));
  EXPECT_FALSE(keeps_bound(most, std::numeric_limits<double>::quiet_NaN()));
}

TEST(Stability, CasesAreChosenByNameByPartAndByWhatIsBroken) {
  const auto names = [](const StabilitySettings& settings) {
    std::vector<std::string> found;
    for (const StabilityRow& row : measure_stability(settings, {})) {
      found.push_back(row.of->name + (row.pass ? "" : "!"));
    }
    return found;
  };
  StabilitySettings settings;
  settings.trial.fast = true;
  settings.cases = {"poles", "all-black"};
  EXPECT_THAT(names(settings), testing::ElementsAre("all-black", "poles"));
  settings.broken = {"poles-in-floats"};
  EXPECT_THAT(names(settings), testing::ElementsAre("all-black", "poles", "poles-in-floats!"));
  settings.cases.clear();
  EXPECT_THAT(names(settings), testing::ElementsAre("poles-in-floats!"));
}

TEST(Stability, AnUnknownNameIsAnErrorWithTheNamesThereAre) {
  StabilitySettings settings;
  settings.cases = {"poels"};
  const auto measure = [&] { static_cast<void>(measure_stability(settings, {})); };
  EXPECT_THAT(test::error_of(measure),
              testing::AllOf(testing::HasSubstr("--case"), testing::HasSubstr("\"poels\""),
                             testing::HasSubstr(" poles ")));
  settings = {};
  settings.parts = {"weather"};
  EXPECT_THAT(test::error_of(measure),
              testing::AllOf(testing::HasSubstr("--part"), testing::HasSubstr(" rotation ")));
}

TEST(Stability, TheReportHasARowACase) {
  StabilitySettings settings;
  settings.trial.fast = true;
  settings.cases = {"poles"};
  settings.broken = {"all-black"};
  const nlohmann::json report = to_json(measure_stability(settings, {}));
  EXPECT_EQ(report.at("experiment"), "stability");
  EXPECT_EQ(report.at("failed"), 1);
  ASSERT_EQ(report.at("rows").size(), 2u);
  const nlohmann::json& row = report.at("rows")[1];
  EXPECT_EQ(row.at("case"), "poles");
  EXPECT_EQ(row.at("part"), "harmonics");
  EXPECT_EQ(row.at("bound"), 2.5e-12);
  EXPECT_EQ(row.at("pass"), true);
  EXPECT_TRUE(row.at("measured").is_number());
  for (const char* const field : {"quantity", "why", "note", "seconds", "bound_is"}) {
    EXPECT_TRUE(row.contains(field)) << field;
  }
  EXPECT_THAT(to_csv(report.at("rows")), testing::HasSubstr("\"poles\""));
}

TEST(Stability, ACaseThatThrowsHasFailedAndSaysWhy) {
  const StabilityCase throws{
      "throws",
      "x",
      "y",
      BoundKind::at_most,
      1,
      "z",
      [](const StabilityTrial&) -> StabilityMeasure { throw Error("here", "this", "that"); }};
  const StabilityRow row = measure_case(throws, {});
  EXPECT_FALSE(row.pass);
  EXPECT_THAT(row.measured.note, testing::HasSubstr("found this, expected that"));
  const std::vector<StabilityRow> rows = {row};
  EXPECT_TRUE(to_json(rows).at("rows")[0].at("measured").is_null());
}

}  // namespace
}  // namespace rimlight
