#include "core/report/adaptive_sh_report.h"

#include <gtest/gtest.h>

#include <set>

#include "core/base/check.h"
#include "core/scene/shapes.h"

namespace rimlight {
namespace {

/// A ball over a ring, so that there are shadows.
AdaptiveShSettings small_settings() {
  AdaptiveShSettings settings;
  settings.meshes.push_back({"ball", {make_sphere(1, 20), make_torus(1.5, 0.6, 20)}});
  settings.lights.push_back(std::make_shared<const Environment>(builtin_environment("studio")));
  settings.degrees = {5, 4};
  settings.places = 3;
  settings.frames = 3;
  return settings;
}

std::vector<AdaptiveShRow> measure(const AdaptiveShSettings& settings) {
  return measure_adaptive_sh(settings, [](const std::string&, double) {});
}

TEST(AdaptiveSh, HasARowForEachDegreeAndPolicy) {
  const auto rows = measure(small_settings());
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0].policy, "multi-level");
  EXPECT_EQ(rows[1].policy, "view");
  EXPECT_EQ(rows[0].degree, 5);
  EXPECT_EQ(rows[2].degree, 4);
  for (const AdaptiveShRow& row : rows) {
    EXPECT_EQ(row.mesh, "ball");
    EXPECT_EQ(row.light, "studio");
    EXPECT_EQ(row.coefficients, static_cast<std::size_t>((row.degree + 1) * (row.degree + 1)));
    EXPECT_GT(row.visible, 100u);
    EXPECT_LT(row.visible, row.vertices);
    EXPECT_GT(row.fps_full, 0);
    EXPECT_GT(row.fps_adaptive, 0);
    EXPECT_GT(row.full_of_peak, 0);
    EXPECT_LT(row.full_of_peak, 1.5);
    EXPECT_GE(row.psnr_db, row.least_psnr_db);
    EXPECT_LE(row.fps_view_moves, row.fps_adaptive);
    EXPECT_EQ(row.view_ms > 0, row.policy == "view");
  }
}

TEST(AdaptiveSh, WithoutThresholdsIsTheFullCalculation) {
  AdaptiveShSettings settings = small_settings();
  settings.threshold = settings.tolerance = 0;
  for (const AdaptiveShRow& row : measure(settings)) {
    EXPECT_GT(row.least_psnr_db, 55) << row.policy;
    EXPECT_LT(row.flicker, 0.02) << row.policy;
    EXPECT_EQ(row.filtered_diffuse, 0);
    EXPECT_EQ(row.filtered_specular, 0);
  }
}

TEST(AdaptiveSh, ViewTransportIsBetterAndSteadierThanFiltering) {
  const auto rows = measure(small_settings());
  for (std::size_t i = 0; i < rows.size(); i += 2) {
    const AdaptiveShRow &filtering = rows[i], &view = rows[i + 1];
    EXPECT_GT(filtering.filtered_specular, 0);
    EXPECT_GT(view.psnr_db, 44);
    EXPECT_GE(view.psnr_db, filtering.psnr_db);
    EXPECT_LE(view.flicker, filtering.flicker / 4);
  }
}

TEST(AdaptiveSh, ReportsASpeedUpOnlyOverAFullCalculationNearPeak) {
  AdaptiveShRow row;
  row.mesh = "a";
  row.speedup = 3;
  row.full_of_peak = 0.59;
  AdaptiveShRow near = row;
  near.full_of_peak = 0.61;
  near.view_ms = 2;
  const auto report = to_json(std::vector{row, near});
  EXPECT_EQ(report["experiment"], "adaptive-sh");
  EXPECT_TRUE(report["rows"][0]["speedup"].is_null());
  EXPECT_EQ(report["rows"][1]["speedup"], 3);
  EXPECT_TRUE(report["rows"][0]["view_ms"].is_null());
  std::set<std::string> names;
  for (const auto& [name, value] : report["rows"][0].items()) names.insert(name);
  EXPECT_EQ(names,
            (std::set<std::string>{"mesh", "light", "policy", "degree", "coefficients", "vertices",
                                   "visible", "fps_full", "full_of_peak", "fps_adaptive", "speedup",
                                   "psnr_db", "least_psnr_db", "filtered_diffuse",
                                   "filtered_specular", "flicker", "view_ms", "fps_view_moves"}));
}

TEST(AdaptiveSh, RefusesEmptyListsAndBadDegrees) {
  AdaptiveShSettings settings = small_settings();
  settings.degrees = {33};
  EXPECT_THROW(measure(settings), CheckFailure);
  settings.degrees = {};
  EXPECT_THROW(measure(settings), CheckFailure);
  settings = small_settings();
  settings.lights.clear();
  EXPECT_THROW(measure(settings), CheckFailure);
}

}  // namespace
}  // namespace rimlight
