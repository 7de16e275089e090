#include "core/report/report_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <sstream>

#include "core/base/files.h"
#include "core/image/image_file.h"
#include "core/report/error_vs_time_json.h"
#include "core/report/figures.h"
#include "core/report/gnuplot.h"
#include "core/report/run_summary.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using nlohmann::json;
using test::TemporaryFolder;

/// A report of two policies and eight frames: the light moves in frames 1 and 2.
ErrorVsTimeReport small_report() {
  ErrorVsTimeReport report;
  report.scene = "a \"scene\"";
  report.sequence = "turn";
  report.has_reference_rows = true;
  report.receivers = 8192;
  report.cube_size = 4;
  for (const char* const run : {"pbi@30", "benefit@16ms"}) {
    for (int frame = 0; frame < 8; ++frame) {
      FrameRow row;
      row.light = "sun, noon";
      row.run = run;
      row.policy = run[0] == 'p' ? "pbi" : "benefit";
      row.budget = run[0] == 'p' ? "30" : "16ms";
      row.frame = frame;
      row.moving = frame == 1 || frame == 2;
      row.frames_since_edit = frame < 3 ? 0 : frame - 2;
      row.ms = {1, 0.5, 2.0 + frame, 0.25, 0.125};
      row.relative_l2 = 0.1 / (1 + frame);
      row.psnr_db = 30 + frame;
      row.lighting_error = frame == 7 ? 0 : 0.2;
      if (frame > 0) row.estimate = 0.09;
      row.reset_bands = frame == 2 ? 0b11 : 0;
      row.columns = 5;
      row.columns_of_band = {3, 2};
      report.rows.push_back(row);
    }
  }
  LightReport light;
  light.light = "sun, noon";
  light.spatio_temporal_norms = {{3, 2}, {1, 0}};
  light.coverage = {{"pbi@30", 0, 5, {std::vector<double>(96, 0.5), {3, 0}}}};
  report.lights = {light};
  return report;
}

TEST(ReportFiles, JsonHasWhatEveryReportHas) {
  const json report = to_json(small_report());
  EXPECT_EQ(report.at("experiment"), "error-vs-time");
  EXPECT_GE(report.at("machine").at("threads").get<int>(), 1);
  EXPECT_FALSE(report.at("machine").at("processor").get<std::string>().empty());
  EXPECT_EQ(report.at("reference"), "uncompressed");
  ASSERT_EQ(report.at("rows").size(), 16u);
  for (const json& row : report.at("rows")) {
    for (const char* const name :
         {"scene", "light", "sequence", "policy", "budget", "frame", "moving", "frames_since_edit",
          "ms", "relative_l2", "psnr_db", "estimate", "psnr_time_db", "lighting_error", "ghost",
          "columns", "bytes", "bands_reset"}) {
      EXPECT_TRUE(row.contains(name)) << name;
    }
  }
  const json& row = report.at("rows")[2];
  EXPECT_EQ(row.at("budget"), 30);
  EXPECT_EQ(report.at("rows")[9].at("budget"), "16ms");
  EXPECT_DOUBLE_EQ(row.at("ms"), 1 + 0.5 + 4 + 0.25 + 0.125);
  EXPECT_EQ(row.at("bands_reset"), 2);
  EXPECT_TRUE(report.at("rows")[0].at("estimate").is_null());
  ErrorVsTimeReport stored = small_report();
  stored.has_reference_rows = false;
  EXPECT_EQ(to_json(stored).at("reference"), "stored");
}

TEST(ReportFiles, SummariesAreMeansOfMotionAndOfWhatComesAfter) {
  const auto runs = summarize_runs(small_report().rows);
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0].moving.frames, 2u);
  EXPECT_NEAR(runs[0].moving.relative_l2, (0.1 / 2 + 0.1 / 3) / 2, 1e-12);
  EXPECT_DOUBLE_EQ(runs[0].moving.psnr_db, 31.5);
  EXPECT_DOUBLE_EQ(runs[0].moving.median_ms, 1 + 0.5 + 4 + 0.25 + 0.125);
  EXPECT_EQ(runs[0].still.frames, 5u);  // not the one before the light moved
  EXPECT_EQ(runs[0].just_after.frames, 1u);
  EXPECT_DOUBLE_EQ(runs[0].just_after.psnr_db, 37);
  EXPECT_EQ(mean_of({}).frames, 0u);
}

TEST(ReportFiles, CsvHasALineForEachRowAndAsManyFieldsInEach) {
  std::istringstream lines(to_csv(to_json(small_report()).at("rows")));
  std::vector<std::size_t> fields;
  for (std::string line; std::getline(lines, line);) {
    std::size_t count = 1;
    bool quoted = false;
    for (const char c : line) {
      if (c == '"') quoted = !quoted;
      count += c == ',' && !quoted;
    }
    fields.push_back(count);
  }
  ASSERT_EQ(fields.size(), 17u);
  for (const std::size_t count : fields) EXPECT_EQ(count, fields.front());
  EXPECT_GT(fields.front(), 20u);
  EXPECT_THAT(to_csv(to_json(small_report()).at("rows")),
              ::testing::HasSubstr("\"a \"\"scene\"\"\""));
}

TEST(ReportFiles, AreWrittenToANewFolderAndRefusedWhereThereCanBeNone) {
  const TemporaryFolder folder;
  write_report(to_json(small_report()), folder / "a");
  EXPECT_EQ(json::parse(read_file(folder / "a" / "error-vs-time.json", 1 << 20)),
            to_json(small_report()));
  EXPECT_EQ(read_file(folder / "a" / "error-vs-time.csv", 1 << 20),
            to_csv(to_json(small_report()).at("rows")));
  const auto file = folder / "a" / "error-vs-time.csv";
  EXPECT_THAT(test::error_of([&] { write_report(to_json(small_report()), file / "b"); }),
              ::testing::HasSubstr("a folder to write to"));
}

TEST(Figures, EachHasAScriptAndWithGnuplotAPicture) {
  const TemporaryFolder folder;
  const Figures figures = draw_figures(small_report(), folder.path());
  EXPECT_EQ(figures.scripts.size(), 8u);
  for (const auto& script : figures.scripts) {
    EXPECT_THAT(read_file(script, 1 << 20), ::testing::HasSubstr("plot ")) << script;
    EXPECT_TRUE(script.filename().string().ends_with("-sun__noon.gp")) << script;
  }
  if (figures.pictures.empty()) GTEST_SKIP() << "gnuplot is not installed";
  ASSERT_EQ(figures.pictures.size(), figures.scripts.size());
  for (const auto& picture : figures.pictures) {
    EXPECT_GT(std::filesystem::file_size(picture), 2000u) << picture;
  }
}

TEST(Figures, OfFramesThatAreAllExactLeaveOutWhatALogarithmCannotShow) {
  const TemporaryFolder folder;
  ErrorVsTimeReport report = small_report();
  for (FrameRow& row : report.rows) row.lighting_error = row.relative_l2 = 0;
  const Figures figures = draw_figures(report, folder.path());
  EXPECT_EQ(figures.scripts.size(), 5u);  // not the three whose axis is an error's
}

TEST(Gnuplot, TextIsNeverACommand) {
  EXPECT_EQ(gnuplot_quote("a\"b`c\\d\ne"), "\"a\\\"b\\`c\\\\d e\"");
  const TemporaryFolder folder;
  const auto path = folder / "broken.gp";
  write_file_atomically(path, "plot nothing at all\n");
  // Without gnuplot it answers so; with it, it says what is wrong.
  const std::string error = test::error_of([&] { EXPECT_FALSE(run_gnuplot(path)); });
  EXPECT_TRUE(error == "no error" || error.find("broken.gp") != std::string::npos) << error;
}

}  // namespace
}  // namespace rimlight
