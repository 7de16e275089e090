#include "core/report/error_vs_time.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "core/light/light_sequence_source.h"
#include "core/report/run_summary.h"
#include "tests/support/ball_source.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using ::testing::HasSubstr;

constexpr int kMoving = 11, kStill = 12;

LightSequence short_turn() {
  return parse_light_sequence(R"({ "name": "turn", "still_frames": 12, "tracks": [
      { "light": "given", "rotate": { "axis": [0, 1, 0], "degrees_per_frame": 4, "frames": 12,
                                      "ease_in": 3, "ease_out": 3 } } ] })",
                              "turn", ".");
}

/// One bake of a ball of 64 × 64 pixels and a report on it, made once.
class ErrorVsTime : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    bake_ball(*folder_ / "ball.bake", test::BallSource(64, 16), 64 * 64);
    bake_ = new Bake(*folder_ / "ball.bake");
    ErrorVsTimeSettings settings;
    settings.sequence = short_turn();
    settings.policies.clear();
    for (const char* const policy :
         {"nwa@10", "nwa@40", "nwa@160", "pbi@200", "bi@1536", "benefit@nwa@160",
          "benefit@bytes:nwa@160", "benefit@1000ms"}) {
      settings.policies.push_back(parse_timed_policy(policy, "test"));
    }
    report_ = new ErrorVsTimeReport(measure_error_vs_time(
        *bake_, settings,
        [](const std::string&, double share) { EXPECT_TRUE(share >= 0 && share <= 1); }));
  }
  static void TearDownTestSuite() {
    delete report_;
    delete bake_;
    delete folder_;
  }

  static std::vector<FrameRow> rows_of(const std::string& run, const std::string& light) {
    std::vector<FrameRow> rows;
    for (const FrameRow& row : report_->rows) {
      if (row.run == run && row.light == light) rows.push_back(row);
    }
    return rows;
  }

  static test::TemporaryFolder* folder_;
  static Bake* bake_;
  static ErrorVsTimeReport* report_;
};
test::TemporaryFolder* ErrorVsTime::folder_ = nullptr;
Bake* ErrorVsTime::bake_ = nullptr;
ErrorVsTimeReport* ErrorVsTime::report_ = nullptr;

TEST_F(ErrorVsTime, HasARowForEveryLightPolicyAndFrame) {
  EXPECT_TRUE(report_->has_reference_rows);
  EXPECT_EQ(report_->sequence, "turn");
  EXPECT_GT(report_->receivers, 2500u);  // of the ball's disc, all
  std::map<std::pair<std::string, std::string>, int> counts;
  for (const FrameRow& row : report_->rows) {
    EXPECT_EQ(row.frame, (counts[{row.light, row.run}]++));
    EXPECT_EQ(row.moving, row.frame >= 1 && row.frame <= kMoving) << row.frame;
    EXPECT_EQ(row.frames_since_edit, row.frame <= kMoving ? 0 : row.frame - kMoving);
    EXPECT_GT(row.ms.light + row.ms.display, 0);
    EXPECT_GT(row.ms.encode, 0);
    EXPECT_TRUE(std::isfinite(row.relative_l2) && row.relative_l2 >= 0);
    EXPECT_TRUE(row.psnr_db > 0 && row.psnr_db <= 99);
  }
  EXPECT_EQ(counts.size(), 2u * 8);
  for (const auto& [run, count] : counts) EXPECT_EQ(count, 1 + kMoving + kStill) << run.second;
}

TEST_F(ErrorVsTime, OfMotionFallsAsTheBudgetGrows) {
  int compared = 0;
  for (const RunSummary& a : summarize_runs(report_->rows)) {
    for (const RunSummary& b : summarize_runs(report_->rows)) {
      if (a.light != b.light || a.policy != "nwa" || b.policy != "nwa") continue;
      if (std::stoi(a.budget) >= std::stoi(b.budget)) continue;
      ++compared;
      EXPECT_GT(a.moving.relative_l2, b.moving.relative_l2) << a.run << " " << b.run;
      EXPECT_GT(a.moving.lighting_error, b.moving.lighting_error) << a.run << " " << b.run;
      EXPECT_LT(a.moving.psnr_db, b.moving.psnr_db) << a.run << " " << b.run;
    }
  }
  EXPECT_EQ(compared, 2 * 3);
}

TEST_F(ErrorVsTime, OfTimeEndsWhereEveryColumnIsShown) {
  constexpr double kRoundings = 1e-5;  // of sums in fp32 in another order
  for (const char* const light : {"sunny", "studio"}) {
    for (const char* const run : {"pbi@200", "bi@1536", "benefit@1000ms"}) {
      const FrameRow last = rows_of(run, light).back();
      EXPECT_EQ(last.lighting_error, 0) << light << " " << run;
      EXPECT_LT(last.time_l2, kRoundings);
      EXPECT_NEAR(last.relative_l2, last.compression_l2, kRoundings);
      EXPECT_GT(last.compression_l2, 1e-4);  // the bake leaves something out
      EXPECT_EQ(last.columns, 0u);           // nothing is left to do
      EXPECT_GT(last.psnr_time_db, last.psnr_db);
      EXPECT_NEAR(last.ghost, last.ghost_of_target, 1e-6 * last.ghost_of_target);
    }
    // Whole budgets are exact in motion too; what does not remember stays as wrong as it was.
    for (const FrameRow& row : rows_of("bi@1536", light)) EXPECT_LT(row.time_l2, kRoundings);
    EXPECT_GT(rows_of("nwa@10", light).back().time_l2, 1e-3);
  }
}

TEST_F(ErrorVsTime, StartsFromTheExactImageOfTheFirstFrame) {
  for (const char* const run : {"pbi@200", "bi@1536"}) {
    const FrameRow first = rows_of(run, "sunny").front();
    EXPECT_EQ(first.columns, 0u);
    EXPECT_LT(first.time_l2, 1e-6);
    EXPECT_NEAR(first.relative_l2, first.compression_l2, 1e-6);
  }
}

TEST_F(ErrorVsTime, IsWhatTheEstimateSays) {
  int close = 0, count = 0;
  for (const FrameRow& row : report_->rows) {
    ASSERT_TRUE(row.estimate);
    ++count;
    close += std::abs(*row.estimate - row.relative_l2) <= 0.15 * row.relative_l2;
  }
  EXPECT_GT(close, 0.8 * count) << close << " of " << count;
}

TEST_F(ErrorVsTime, CountsColumnsByBandAndBandsThatStartAfresh) {
  const std::uint32_t all_bands = (1u << CubeHaar(16).band_count()) - 1;
  int checked = 0;
  for (const FrameRow& row : report_->rows) {
    if (row.policy != "nwa" && row.policy != "pbi") continue;
    ++checked;
    std::size_t columns = 0;
    for (const int of_band : row.columns_of_band) columns += static_cast<std::size_t>(of_band);
    EXPECT_EQ(columns, row.columns) << row.run << " " << row.frame;
    if (row.policy == "nwa") {
      EXPECT_EQ(row.reset_bands, all_bands);
    }
  }
  EXPECT_GT(checked, 0);
}

TEST_F(ErrorVsTime, GivesAPolicyWhatAnotherSpent) {
  for (const char* const light : {"sunny", "studio"}) {
    const std::vector<FrameRow> rows = rows_of("nwa@160", light);
    const FrameMeans spent = mean_of(frames_that_count(rows));
    EXPECT_EQ(spent.frames, static_cast<std::size_t>(kMoving));
    const auto given = [&](const char* run) {
      return parse_budget(rows_of(run, light).front().budget, "test");
    };
    EXPECT_EQ(given("benefit@nwa@160").unit, FrameBudget::Unit::milliseconds);
    EXPECT_NEAR(given("benefit@nwa@160").amount, spent.median_ms, 1e-6);
    EXPECT_NEAR(given("benefit@bytes:nwa@160").amount, spent.median_bytes, 1);
    EXPECT_GT(spent.median_bytes, 0);
    for (const FrameRow& row : rows_of("benefit@bytes:nwa@160", light)) {
      EXPECT_LE(static_cast<double>(row.bytes), spent.median_bytes);
    }
  }
}

TEST_F(ErrorVsTime, RefusesPoliciesThatCannotFollowOneAnother) {
  ErrorVsTimeSettings settings;
  settings.sequence = short_turn();
  settings.policies = {parse_timed_policy("benefit@pbi@30", "x"),
                       parse_timed_policy("pbi@30", "x")};
  const auto error = [&] {
    return test::error_of([&] { measure_error_vs_time(*bake_, settings, {}); });
  };
  EXPECT_THAT(error(), HasSubstr("no earlier \"pbi@30\""));
  settings.policies = {settings.policies[1], settings.policies[1]};
  EXPECT_THAT(error(), HasSubstr("pbi@30"));
}

TEST(ErrorVsTimeWithoutRows, IsMeasuredAgainstTheStoredTransport) {
  const test::TemporaryFolder folder;
  bake_ball(folder / "plain.bake", test::BallSource(64, 8), 0);
  const Bake bake(folder / "plain.bake");
  ErrorVsTimeSettings settings;
  settings.sequence = short_turn();
  settings.most_frames = 4;
  settings.policies = {parse_timed_policy("bi@384", "x"), parse_timed_policy("nwa@20", "x")};
  settings.lights = {std::make_shared<const Environment>(builtin_environment("cathedral"))};
  const ErrorVsTimeReport report = measure_error_vs_time(bake, settings, {});
  EXPECT_FALSE(report.has_reference_rows);
  ASSERT_EQ(report.rows.size(), 2u * 4);
  for (const FrameRow& row : report.rows) {
    EXPECT_EQ(row.light, "cathedral");
    EXPECT_EQ(row.compression_l2, 0);
    EXPECT_EQ(row.relative_l2, row.time_l2);
    if (row.policy == "bi") {
      EXPECT_LT(row.relative_l2, 1e-5);
    } else {
      EXPECT_GT(row.relative_l2, 1e-3);
    }
  }
}

}  // namespace
}  // namespace rimlight
