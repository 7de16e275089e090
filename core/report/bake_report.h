#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "core/bake/transport_bake.h"
#include "core/report/gnuplot.h"
#include "core/report/report_page.h"
#include "core/transport/bake_folder.h"

namespace rimlight {

/// What making a bake cost, and what came of it.
struct BakeReport {
  std::string scene, kind;
  int width = 0, height = 0, cube_size = 0;
  std::size_t covered = 0;  // pixels that geometry covers in part or wholly
  double asked_psnr_db = 0;
  BakeSummary summary;
};
BakeReport bake_report(const Bake& bake, double asked_psnr_db, const BakeSummary& summary);

/// docs/formats/report.md.
nlohmann::json to_json(const BakeReport& report);
ReportSection section_of(const BakeReport& report);
/// None: a bake is one point.
Figures draw_figures(const BakeReport& report, const std::filesystem::path& folder);

}  // namespace rimlight
