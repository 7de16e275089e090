#include "core/report/equal_time.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/bake/image_bake.h"
#include "core/light/environment.h"
#include "core/report/report_files.h"
#include "tests/core/bake/bake_scenes.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using test::error_of;
using test::TemporaryFolder;

EqualTimeReport made_up() {
  EqualTimeReport report;
  report.scene = "made up";
  report.rows = {{"sun", kPathTracing, kTracedPicture, 1, 10, 20},
                 {"sun", kPathTracing, kTracedPicture, 100, 1000, 40},
                 {"sun", "benefit@8ms", kBakedPicture, 1, 8, 38},
                 {"sun", "benefit@8ms", kBakedPicture, 2, 16, 42},
                 {"sun", "benefit@8ms", kTracedPicture, 1, 8, 35},
                 {"other", "benefit@8ms", kBakedPicture, 1, 5, 50}};
  return report;
}

TEST(EqualTime, TimesAreFoundBetweenRowsByTheLogarithmOfTime) {
  const EqualTimeReport report = made_up();
  const EqualTimeRow traced = report.rows[0], ours = report.rows[2], held = report.rows[4];
  EXPECT_NEAR(milliseconds_to(report, traced, 30).value(), 100, 1e-9);
  EXPECT_NEAR(milliseconds_to(report, traced, 40).value(), 1000, 1e-9);
  EXPECT_NEAR(milliseconds_to(report, ours, 40).value(), std::sqrt(128), 1e-9);
  EXPECT_EQ(milliseconds_to(report, ours, 10), 8);
  EXPECT_EQ(milliseconds_to(report, held, 35), 8);
  EXPECT_EQ(milliseconds_to(report, held, 40), std::nullopt);
  EXPECT_EQ(milliseconds_to(report, traced, 41), std::nullopt);
  EXPECT_EQ(milliseconds_to(report, {}, 1), std::nullopt);
}

TEST(EqualTime, ItsReportHasRowsTimesAndAPictureALight) {
  const EqualTimeReport report = made_up();
  const nlohmann::json json = to_json(report);
  EXPECT_EQ(json["experiment"], "equal-time");
  EXPECT_EQ(json["rows"].size(), report.rows.size());
  EXPECT_NEAR(json["summary"][0]["ms_to_40_db"].get<double>(), 1000, 1e-9);
  EXPECT_EQ(json["summary"][0]["ms_to_45_db"], nullptr);
  const ReportSection section = section_of(report);
  const auto& cells = section.tables[0].rows[1];
  EXPECT_EQ(cells[cells.size() - 2], fixed(1000 / std::sqrt(128), 1));
  EXPECT_EQ(cells.back(), "42.0");
  const TemporaryFolder folder;
  write_report(json, folder.path());
  EXPECT_EQ(draw_figures(report, folder.path()).scripts.size(), 2u);
}

/// A bake and a path tracer that know nothing of each other come to one picture.
TEST(EqualTime, RelightingAndPathTracingMeetInOnePicture) {
  const TemporaryFolder folder;
  auto scene = corner_scene(lambert(0.7f));
  scene->bake.width = scene->bake.height = 32;
  scene->bake.cube_size = 8;
  scene->bake.bounces = 2;
  scene->bake.primary_rays = 64;
  scene->bake.reference_receivers = 4096;
  scene->environments.assign(1, builtin_environment("studio"));
  bake_image(scene, folder / "corner.bake", [](const BakeProgress&) {});
  const Bake bake(folder / "corner.bake");
  EqualTimeSettings settings;
  settings.policies = {parse_timed_policy("benefit@1000ms", "test")};
  settings.seconds = 1.5;
  settings.frames = 2;
  const EqualTimeReport report =
      measure_equal_time(scene, bake, settings, [](const std::string&, double) {});
  EXPECT_EQ(report.receivers, bake.coverage().size());
  double first_traced = 0, last_traced = 0, last_ours = 0, last_baked = 0, before = 0;
  for (const EqualTimeRow& row : report.rows) {
    if (row.method == kPathTracing && row.steps == 1) first_traced = row.psnr_db;
    if (row.method == kPathTracing) last_traced = row.psnr_db;
    if (row.method == "benefit@1000ms") {
      (row.against == kTracedPicture ? last_ours : last_baked) = row.psnr_db;
    }
    EXPECT_GT(row.ms, row.steps == 1 ? 0 : before);
    before = row.ms;
  }
  EXPECT_GT(first_traced, 5);
  EXPECT_GT(last_traced, first_traced + 10);
  EXPECT_GT(last_baked, 48);  // what compression leaves out
  EXPECT_GT(last_ours, 36);   // what the bake's own noise leaves
}

TEST(EqualTime, ABakeOfAnotherPictureIsRefused) {
  const TemporaryFolder folder;
  auto scene = corner_scene(lambert(0.7f));
  scene->environments.assign(1, builtin_environment("studio"));
  scene->bake.width = scene->bake.height = 16;
  scene->bake.cube_size = 4;
  scene->bake.primary_rays = 4;
  bake_image(scene, folder / "corner.bake", [](const BakeProgress&) {});
  const Bake bake(folder / "corner.bake");
  auto larger = std::make_shared<Scene>(*scene);
  larger->bake.width = 32;
  EXPECT_NE(error_of([&] {
              measure_equal_time(larger, bake, {}, [](const std::string&, double) {});
            }).find("32 x 16"),
            std::string::npos);
}

}  // namespace
}  // namespace rimlight
