#include "core/report/brdf_edit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/curves/curve_session_source.h"
#include "core/report/brdf_edit_report.h"
#include "core/report/brdf_edit_summary.h"
#include "core/scene/scene_source.h"
#include "tests/support/ball_source.h"
#include "tests/support/curve_bake.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using ::testing::HasSubstr;

// A whole curve, a small drag, another material, the first one's other axis, and back.
constexpr const char* kSession = R"({ "name": "short", "edits": [
  { "material": "pearl", "axis": "half_angle", "scale": "logarithmic", "title": "set",
    "points": [[0, 20], [0.2, 9], [0.5, 0.3], [1, 0]], "rest": 3 },
  { "material": "pearl", "axis": "half_angle", "title": "small",
    "drag": [[1, 0.21, 9.5]], "frames": 8, "rest": 6 },
  { "material": "wax", "axis": "half_angle", "points": [[0, 3], [0.5, 1], [1, 0]], "rest": 2 },
  { "material": "pearl", "axis": "difference_angle", "title": "Fresnel",
    "points": [[0, 0.05], [0.7, 0.2], [1, 1]], "rest": 2 },
  { "material": "pearl", "axis": "half_angle", "title": "back",
    "drag": [[0, 0, 25]], "frames": 3, "rest": 2 } ] })";

const std::vector<std::string>& run_names() {
  static const std::vector<std::string> names = {
      "nwa@5",   "bi@5",   "benefit@5",   "nwa@20",      "bi@20",   "benefit@20",
      "nwa@256", "bi@256", "benefit@256", "benefit@1MB", "bi@16ms", "bi@30"};
  return names;
}

const std::shared_ptr<const Bake>& bake() {
  static const test::TemporaryFolder folder;
  static const auto opened = [] {
    test::bake_balls_with_curves(folder / "balls.bake");
    return std::make_shared<const Bake>(folder / "balls.bake");
  }();
  return opened;
}

BrdfEditReport measure(const CurveSession& session, int most_frames = 0) {
  BrdfEditSettings settings{.session = session, .light = nullptr, .most_frames = most_frames};
  settings.runs.clear();
  for (const std::string& name : run_names()) {
    settings.runs.push_back(parse_curve_run(name, "run"));
  }
  return measure_brdf_edit(bake(), settings, {});
}

const BrdfEditReport& report() {
  static const BrdfEditReport measured = measure(parse_curve_session(kSession, "short"));
  return measured;
}

std::vector<CurveFrameRow> rows_of(const std::string& run) {
  std::vector<CurveFrameRow> rows;
  std::ranges::copy_if(report().rows, std::back_inserter(rows),
                       [&](const CurveFrameRow& row) { return row.run == run; });
  EXPECT_FALSE(rows.empty()) << run;
  return rows;
}

TEST(BrdfEdit, HasARowForEveryRunAndFrame) {
  const CurveSession& session = report().session;
  const auto frames = static_cast<std::size_t>(session.frame_count());
  ASSERT_EQ(report().rows.size(), run_names().size() * frames);
  EXPECT_EQ(report().light, "studio");
  EXPECT_EQ(report().scene, "balls");
  EXPECT_GT(report().row_count, 300u);
  for (std::size_t i = 0; i < report().rows.size(); ++i) {
    const CurveFrameRow& row = report().rows[i];
    EXPECT_EQ(row.run, run_names()[i / frames]);
    ASSERT_EQ(row.frame, static_cast<int>(i % frames));
    const auto place = session.place(row.frame);
    EXPECT_EQ(row.stroke, place.stroke);
    EXPECT_EQ(row.moving, place.is_moving);
    const int still = place.step - session.strokes[place.stroke].frames + 1;
    EXPECT_EQ(row.frames_since_edit, std::max(still, 0)) << row.frame;
  }
}

TEST(BrdfEdit, AllTermsLeaveRoundingAlone) {
  int moving = 0;
  for (const char* const run : {"nwa@256", "bi@256", "benefit@256"}) {
    for (const CurveFrameRow& row : rows_of(run)) {
      EXPECT_TRUE(row.exact) << run << row.frame;
      // Some 4,000 additions, of 2⁻²⁴ each of sums that may be ten times what is left of them.
      EXPECT_LT(row.error_l2, 10 * std::sqrt(4000 / 3.0) * 0x1p-24) << run << row.frame;
      EXPECT_EQ(row.estimate, 0);
      moving += int{row.moving};
    }
  }
  EXPECT_GT(moving, 30);
}

TEST(BrdfEdit, BudgetsOfTermsAndBytesAreKept) {
  bool any_full = false;
  for (const CurveFrameRow& row : report().rows) {
    if (row.budget == "5") {
      EXPECT_LE(row.terms, 5u);
    }
    if (row.budget == "1MB") {
      EXPECT_LE(row.bytes, 1'000'000u);
    }
    EXPECT_EQ(row.terms == 0, row.bytes == 0);
    any_full = any_full || (row.budget == "5" && row.terms == 5);
  }
  EXPECT_TRUE(any_full);
}

TEST(BrdfEdit, AfterASmallEditUpdatesLeaveLessThanFreshSums) {
  for (const std::string budget : {"@5", "@20"}) {
    const auto nwa = rows_of("nwa" + budget);
    for (const std::string policy : {"bi", "benefit"}) {
      const auto rows = rows_of(policy + budget);
      int compared = 0;
      for (std::size_t i = 0; i < rows.size(); ++i) {
        if (rows[i].stroke != 1) continue;
        EXPECT_LT(rows[i].error_l2, nwa[i].error_l2) << policy << budget << rows[i].frame;
        ++compared;
      }
      EXPECT_EQ(compared, 14);
    }
  }
}

TEST(BrdfEdit, UpdatesConvergeAtRestAndFreshSumsDoNot) {
  const auto bi = rows_of("bi@20"), nwa = rows_of("nwa@20");
  double before = 1;
  for (std::size_t i = 0; i < bi.size(); ++i) {
    if (bi[i].frames_since_edit == 0) before = bi[i].error_l2;
    // More columns may leave more for a moment, where wavelets overlap in the image.
    EXPECT_LT(bi[i].error_l2, 1.5 * before + 1e-6) << i;
    before = bi[i].error_l2;
    if (nwa[i].frames_since_edit > 1) {
      EXPECT_EQ(nwa[i].error_l2, nwa[i - 1].error_l2);
    }
  }
}

TEST(BrdfEdit, EstimatesAreTheError) {
  int compared = 0;
  for (const CurveFrameRow& row : report().rows) {
    if (!(row.error_l2 > 1e-4)) continue;
    EXPECT_NEAR(row.estimate / row.error_l2, 1, 0.01) << row.run << " " << row.frame;
    ++compared;
  }
  EXPECT_GT(compared, 100);
}

TEST(BrdfEdit, TheExactImageIsTheSumOverAllTexels) {
  ASSERT_EQ(report().strokes.size(), 5u);
  for (std::size_t s = 0; s < 5; ++s) {
    const StrokeReport& stroke = report().strokes[s];
    EXPECT_LT(stroke.stored_l2, 1e-4) << s;  // 16 bits
    EXPECT_GT(stroke.stored_l2, 0) << s;
    // T′ is made once for each material and axis, and again where the other axis was edited.
    EXPECT_EQ(stroke.transport_ms > 0, s != 1) << s;
  }
}

TEST(BrdfEdit, BudgetsThatCountGiveTheSameRowsAgain) {
  const BrdfEditReport again = measure(report().session, 20);
  std::size_t compared = 0;
  for (const CurveFrameRow& row : again.rows) {
    if (row.budget == "16ms") continue;
    const auto first = rows_of(row.run)[static_cast<std::size_t>(row.frame)];
    EXPECT_EQ(row.terms, first.terms);
    EXPECT_EQ(row.bytes, first.bytes);
    EXPECT_EQ(row.error_l2, first.error_l2);
    EXPECT_EQ(row.estimate, first.estimate);
    ++compared;
  }
  EXPECT_EQ(compared, 20 * (run_names().size() - 1));
  EXPECT_EQ(again.strokes.size(), again.session.place(19).stroke + 1);
}

TEST(BrdfEdit, StaleImagesAreNearAndBecomeExact) {
  std::map<std::string, int> causes;
  for (const StaleCurveRow& row : report().stale) {
    ++causes[row.cause];
    EXPECT_LT(row.error_l2, 0.3) << row.cause;
    EXPECT_TRUE(std::isfinite(row.estimate));
    EXPECT_GT(row.quick_ms, 0);
    EXPECT_GT(row.exact_ms, row.quick_ms);
    EXPECT_GT(row.all_ms, row.exact_ms);
  }
  // 8 × 8 texels a face: 256 of the 384 are summed exactly, so that a turn may leave next to none.
  EXPECT_TRUE(std::ranges::any_of(report().stale, [](const StaleCurveRow& row) {
    return row.cause == "environment" && row.error_l2 > 1e-6;
  }));
  EXPECT_EQ(causes,
            (std::map<std::string, int>{{"environment", 2}, {"rotation", 3}, {"other axis", 1}}));
}

TEST(BrdfEdit, RefusesWhatTheBakeDoesNotHave) {
  const auto message = [](const char* edits) {
    return test::error_of([&] {
      measure(parse_curve_session(R"({"name": "bad", "edits": [)" + std::string(edits) + "]}", ""));
    });
  };
  EXPECT_THAT(message(R"({"material": "gold", "axis": "half_angle", "points": [[0, 1]]})"),
              testing::AllOf(HasSubstr("bad: gold: found the material \"gold\""),
                             HasSubstr("\"pearl\" \"wax\"")));
  EXPECT_THAT(message(R"({"material": "wax", "axis": "difference_angle", "points": [[0, 1]]})"),
              HasSubstr("bad: wax: found"));
  const test::TemporaryFolder folder;
  test::bake_ball(folder / "ball.bake", test::BallSource(16, 4), 0);
  EXPECT_THAT(test::error_of([&] {
                measure_brdf_edit(std::make_shared<const Bake>(folder / "ball.bake"),
                                  {parse_curve_session(kSession, "short"), nullptr}, {});
              }),
              HasSubstr("brdf_curve"));
}

TEST(BrdfEdit, TheJsonHasAllRowsAndTheFiguresAreDrawn) {
  const nlohmann::json json = to_json(report());
  EXPECT_EQ(json.at("experiment"), "brdf-edit");
  ASSERT_EQ(json.at("rows").size(), report().rows.size());
  ASSERT_EQ(json.at("edits").size(), 5u);
  EXPECT_EQ(json.at("stale").size(), report().stale.size());
  EXPECT_EQ(json.at("summary").size(), run_names().size());
  const auto& row = json.at("rows")[0];
  EXPECT_EQ(row.at("material"), "pearl");
  EXPECT_EQ(row.at("axis"), "half_angle");
  EXPECT_EQ(row.at("budget"), 5);
  EXPECT_EQ(row.at("edit"), "set");
  EXPECT_EQ(json.at("edits")[3].at("axis"), "difference_angle");
  EXPECT_EQ(json.at("rows")[json.at("rows").size() - 1].at("budget"), 30);

  const test::TemporaryFolder folder;
  const Figures figures = draw_figures(report(), folder.path());
  EXPECT_EQ(figures.scripts.size(), 3u);
}

TEST(CurveRun, TextIsReadAndWritten) {
  for (const char* const text : {"nwa@30", "bi@16ms", "benefit@4MB"}) {
    EXPECT_EQ(parse_curve_run(text, "run").name(), text);
  }
  for (const char* const text : {"pbi@30", "bi", "bi@", "bi@-1", "@30", "bi@30s"}) {
    EXPECT_THAT(test::error_of([&] { parse_curve_run(text, "--policy"); }),
                testing::StartsWith("--policy: found"))
        << text;
  }
  std::set<std::string> names;
  for (const CurveRun& run : default_curve_runs()) names.insert(run.name());
  EXPECT_EQ(names.size(), default_curve_runs().size());
  EXPECT_TRUE(names.contains("benefit@16ms"));
}

CurveFrameRow row(int stroke, int frames_since_edit, double error, bool exact) {
  CurveFrameRow row;
  row.run = "bi@2";
  row.stroke = static_cast<std::size_t>(stroke);
  row.frames_since_edit = frames_since_edit;
  row.moving = frames_since_edit == 0;
  row.error_l2 = error;
  row.exact = exact;
  row.apply_ms = error;
  row.terms = 2;
  return row;
}

TEST(CurveRunSummary, CountsTheFramesUntilACurveIsHeld) {
  std::vector<CurveFrameRow> rows = {row(0, 0, 4, false), row(0, 1, 2, false), row(0, 2, 0, true),
                                     row(1, 0, 6, false), row(1, 0, 8, true),  row(1, 1, 0, true)};
  auto summary = summarize_curve_runs(rows).at(0);
  EXPECT_EQ(summary.frames_to_exact, 3);
  EXPECT_DOUBLE_EQ(summary.moving_error_l2, 6);
  EXPECT_DOUBLE_EQ(summary.worst_error_l2, 8);
  EXPECT_DOUBLE_EQ(summary.last_moving_error_l2, 6);  // of 4 and 8
  EXPECT_DOUBLE_EQ(summary.median_ms, 6);
  EXPECT_DOUBLE_EQ(summary.moving_terms, 2);
  // A stroke without a rest does not count, one with too short a rest leaves nothing to say.
  rows.push_back(row(2, 0, 1, false));
  EXPECT_EQ(summarize_curve_runs(rows).at(0).frames_to_exact, 3);
  rows.push_back(row(2, 1, 1, false));
  EXPECT_EQ(summarize_curve_runs(rows).at(0).frames_to_exact, std::nullopt);
  EXPECT_TRUE(summarize_curve_runs({}).empty());
}

TEST(CurveRunSummary, TheSessionOfPearlsFitsItsScene) {
  const Scene scene = read_scene("configs/scenes/pearl.json");
  EXPECT_EQ(scene.bake.kind, BakeKind::brdf_curve);
  EXPECT_THAT(find_curve_session("pearl", "test").materials(),
              testing::UnorderedElementsAreArray(scene.bake.editable));
}

}  // namespace
}  // namespace rimlight
