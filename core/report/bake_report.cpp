#include "core/report/bake_report.h"

#include <algorithm>

#include "core/report/report_files.h"

namespace rimlight {

BakeReport bake_report(const Bake& bake, double asked_psnr_db, const BakeSummary& summary) {
  const BakeManifest& manifest = bake.manifest();
  const auto covered =
      std::ranges::count_if(bake.coverage(), [](float share) { return share > 0; });
  return {.scene = manifest.scene,
          .kind = manifest.kind,
          .width = manifest.pixels.width,
          .height = manifest.pixels.height,
          .cube_size = manifest.cube_size,
          .covered = static_cast<std::size_t>(covered),
          .asked_psnr_db = asked_psnr_db,
          .summary = summary};
}

nlohmann::json to_json(const BakeReport& report) {
  const BakeSummary& summary = report.summary;
  nlohmann::json row = {{"scene", report.scene},
                        {"kind", report.kind},
                        {"width", report.width},
                        {"height", report.height},
                        {"cube_size", report.cube_size},
                        {"covered", report.covered},
                        {"seconds", summary.seconds},
                        {"resumed_tiles", summary.resumed_tiles},
                        {"bytes", summary.bytes},
                        {"asked_psnr_db", report.asked_psnr_db},
                        {"worst_psnr_db", summary.worst_psnr_db},
                        {"worst_light", summary.worst_light}};
  nlohmann::json rows = nlohmann::json::array();
  rows.push_back(std::move(row));
  return {{"experiment", "bake"}, {"machine", describe_machine()}, {"rows", std::move(rows)}};
}

ReportSection section_of(const BakeReport& report) {
  const BakeSummary& summary = report.summary;
  ReportSection section{.title = "Bake: " + report.scene,
                        .question =
                            "What it takes to bake the scene once, and how near the "
                            "stored transport is to what was traced."};
  if (summary.resumed_tiles > 0) {
    section.remarks.push_back(std::to_string(summary.resumed_tiles) +
                              " tiles were found done: the seconds are without them.");
  }
  const double covered = static_cast<double>(std::max<std::size_t>(1, report.covered));
  section.tables.push_back(
      {.caption = "With the rows that reports measure against",
       .columns = {"kind", "pixels", "texels", "seconds", "MiB", "bytes a covered pixel",
                   "dB asked for", "dB, worst light", "worst light"},
       .rows = {
           {report.kind, std::to_string(report.width) + " x " + std::to_string(report.height),
            "6 x " + std::to_string(report.cube_size) + " x " + std::to_string(report.cube_size),
            fixed(summary.seconds, 1), fixed(static_cast<double>(summary.bytes) / (1 << 20), 1),
            fixed(static_cast<double>(summary.bytes) / covered, 0), fixed(report.asked_psnr_db, 1),
            fixed(summary.worst_psnr_db, 2), summary.worst_light}}});
  return section;
}

Figures draw_figures(const BakeReport&, const std::filesystem::path&) { return {}; }

}  // namespace rimlight
