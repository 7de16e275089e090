#include "core/report/sh_policies.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "core/light/light_sequence_source.h"
#include "core/scene/shapes.h"
#include "tests/support/error_of.h"

namespace rimlight {
namespace {

using Policy = ShPolicyRun::Policy;

constexpr int kDegree = 9;

LightSequence short_turn() {
  return parse_light_sequence(R"({ "name": "turn", "still_frames": 8, "tracks": [
      { "light": "given", "rotate": { "axis": [0, 1, 0], "degrees_per_frame": 2, "frames": 20,
                                      "ease_in": 4, "ease_out": 4 } } ] })",
                              "turn", ".");
}

const std::map<std::string, std::vector<ShPolicyRow>>& rows_by_run() {
  static const auto rows = [] {
    const LitMesh lit = light_mesh("ball", {make_sphere(1, 24)}, kDegree);
    std::map<std::string, std::vector<ShPolicyRow>> by_run;
    for (const ShPolicyRow& row : measure_sh_policies(lit, builtin_environment("studio"),
                                                      {short_turn(),
                                                       0,
                                                       {{Policy::linear, 9},
                                                        {Policy::linear, 100},
                                                        {Policy::pbi, 25},
                                                        {Policy::benefit, 25}}},
                                                      {})) {
      by_run[row.run].push_back(row);
    }
    return by_run;
  }();
  return rows;
}

double mean_error(const std::vector<ShPolicyRow>& rows) {
  double sum = 0;
  int count = 0;
  for (const ShPolicyRow& row : rows) {
    if (!row.moving) continue;
    sum += row.relative_l2;
    ++count;
  }
  EXPECT_GT(count, 15);
  return sum / count;
}

TEST(ShPolicies, HasARowForEveryRunAndFrame) {
  EXPECT_EQ(rows_by_run().size(), 4u);
  for (const auto& [run, rows] : rows_by_run()) {
    ASSERT_EQ(rows.size(), static_cast<std::size_t>(short_turn().frame_count())) << run;
    for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(rows[i].frame, static_cast<int>(i));
  }
}

TEST(ShPolicies, AllCoefficientsLeaveNoError) {
  for (const ShPolicyRow& row : rows_by_run().at("linear@100")) {
    EXPECT_LT(row.relative_l2, 1e-5);  // rounding of incremental sums
    EXPECT_LT(row.largest_jump, 1e-4);
  }
}

TEST(ShPolicies, IncrementalOnesEndWhereTheLightStands) {
  for (const char* const run : {"pbi@25", "benefit@25"}) {
    const auto rows = rows_by_run().at(run);
    EXPECT_LT(rows.front().relative_l2, 1e-6) << run;
    EXPECT_GT(mean_error(rows), 1e-4) << run;
    EXPECT_LT(rows.back().relative_l2, 1e-5) << run;
  }
  EXPECT_LT(mean_error(rows_by_run().at("benefit@25")), mean_error(rows_by_run().at("pbi@25")));
  EXPECT_LT(mean_error(rows_by_run().at("benefit@25")), mean_error(rows_by_run().at("linear@9")));
}

TEST(ShPolicies, RefusesASequenceThatDoesNotTurnOneLight) {
  const LitMesh lit = light_mesh("ball", {make_sphere(1, 8)}, 2);
  const auto blend = parse_light_sequence(R"({ "name": "mix", "tracks": [
      { "blend": { "from": "sunny", "to": "studio", "frames": 5 } } ] })",
                                          "mix", ".");
  EXPECT_THAT(test::error_of([&] {
                measure_sh_policies(lit, builtin_environment("sunny"), {blend, 0, {}}, {});
              }),
              testing::HasSubstr("mix"));
}

}  // namespace
}  // namespace rimlight
