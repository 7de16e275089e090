#include "core/report/error_vs_time_json.h"

#include <algorithm>
#include <string>

#include "core/report/report_files.h"
#include "core/report/run_summary.h"

namespace rimlight {
namespace {

using nlohmann::json;

/// A budget in coefficients as a number, another as text.
json budget_json(const std::string& budget) {
  const bool is_count = std::ranges::all_of(budget, [](char c) { return c >= '0' && c <= '9'; });
  return is_count && budget.size() < 16 ? json(std::stoll(budget)) : json(budget);
}

json number_or_null(const std::optional<double>& number) {
  if (!number) return nullptr;
  return *number;
}

json row_json(const ErrorVsTimeReport& report, const FrameRow& row) {
  json result = {{"scene", report.scene},
                 {"light", row.light},
                 {"sequence", report.sequence},
                 {"policy", row.policy},
                 {"budget", budget_json(row.budget)},
                 {"run", row.run},
                 {"frame", row.frame},
                 {"moving", row.moving},
                 {"frames_since_edit", row.frames_since_edit},
                 {"ms", row.ms.total()},
                 {"light_ms", row.ms.light},
                 {"plan_ms", row.ms.plan},
                 {"apply_ms", row.ms.apply},
                 {"display_ms", row.ms.display},
                 {"encode_ms", row.ms.encode}};
  result.update({{"relative_l2", row.relative_l2},
                 {"psnr_db", row.psnr_db},
                 {"estimate", number_or_null(row.estimate)},
                 {"time_l2", row.time_l2},
                 {"psnr_time_db", row.psnr_time_db},
                 {"compression_l2", row.compression_l2},
                 {"noise_l2", number_or_null(row.of_transport.noise)},
                 {"resolution_l2", number_or_null(row.of_transport.resolution)},
                 {"lighting_error", row.lighting_error},
                 {"ghost", row.ghost},
                 {"ghost_of_target", row.ghost_of_target},
                 {"columns", row.columns},
                 {"bytes", row.bytes},
                 {"reset_bands", row.reset_bands},
                 {"columns_of_band", row.columns_of_band}});
  int bands_reset = 0;
  for (std::uint32_t bands = row.reset_bands; bands != 0; bands &= bands - 1) ++bands_reset;
  result["bands_reset"] = bands_reset;
  return result;
}

json means_json(const FrameMeans& means) {
  if (means.frames == 0) return nullptr;
  return {{"frames", means.frames},
          {"median_ms", means.median_ms},
          {"median_bytes", means.median_bytes},
          {"relative_l2", means.relative_l2},
          {"psnr_db", means.psnr_db},
          {"psnr_time_db", means.psnr_time_db},
          {"lighting_error", means.lighting_error},
          {"ghost", means.ghost}};
}

json summary_json(const RunSummary& summary) {
  return {{"light", summary.light},
          {"run", summary.run},
          {"policy", summary.policy},
          {"budget", budget_json(summary.budget)},
          {"moving", means_json(summary.moving)},
          {"still", means_json(summary.still)},
          {"just_after", means_json(summary.just_after)}};
}

}  // namespace

json to_json(const ErrorVsTimeReport& report) {
  json result = {{"experiment", "error-vs-time"},
                 {"machine", describe_machine()},
                 {"scene", report.scene},
                 {"sequence", report.sequence},
                 {"reference", report.has_reference_rows ? "uncompressed" : "stored"},
                 {"receivers", report.receivers},
                 {"cube_size", report.cube_size},
                 {"rows", json::array()},
                 {"summary", json::array()},
                 {"lights", json::array()}};
  for (const FrameRow& row : report.rows) result["rows"].push_back(row_json(report, row));
  for (const RunSummary& summary : summarize_runs(report.rows)) {
    result["summary"].push_back(summary_json(summary));
  }
  for (const LightReport& light : report.lights) {
    json coverage = json::array();
    for (const CoverageSample& sample : light.coverage) {
      coverage.push_back({{"run", sample.run},
                          {"first_frame", sample.first_frame},
                          {"frames", sample.frames},
                          {"columns_of_band", sample.coverage.columns_of_band}});
    }
    result["lights"].push_back({{"light", light.light},
                                {"spatio_temporal_norms", light.spatio_temporal_norms},
                                {"coverage", coverage}});
  }
  return result;
}

}  // namespace rimlight
