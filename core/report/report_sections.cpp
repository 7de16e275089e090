#include "core/report/report_sections.h"

#include <algorithm>
#include <map>

#include "core/report/brdf_edit_summary.h"
#include "core/report/run_summary.h"

namespace rimlight {

ReportSection section_of(const ErrorVsTimeReport& report) {
  ReportSection section{
      .title = "Error against time: " + report.scene + ", " + report.sequence,
      .question =
          "What each policy shows of a light in motion for the time, or the coefficients, that it "
          "may take, and what is left when the light stands still."};
  section.remarks.push_back(
      std::to_string(report.receivers) + " receivers, 6 x " + std::to_string(report.cube_size) +
      " x " + std::to_string(report.cube_size) + " texels of light; " +
      (report.has_reference_rows
           ? "errors are against the uncompressed transport"
           : "no reference rows (bake --reference): errors are against the stored transport's "
             "exact image, without compression's"));
  Table table{.caption = "Means of the frames in motion; the median of their times",
              .columns = {"light", "policy", "ms", "L2 error", "PSNR, dB", "still: L2 error"}};
  for (const RunSummary& run : summarize_runs(report.rows)) {
    table.rows.push_back({run.light, run.run, fixed(run.moving.median_ms, 2),
                          fixed(run.moving.relative_l2, 4), fixed(run.moving.psnr_db, 2),
                          fixed(run.still.relative_l2, 4)});
  }
  section.tables.push_back(std::move(table));
  return section;
}

ReportSection section_of(const StorageComparison& comparison) {
  ReportSection section{
      .title = "Storage: " + comparison.scene,
      .question =
          "What the bake's storage is worth: bytes against error, beside compressed sparse "
          "rows in floats, pruned by one threshold."};
  Table table{.caption = "Display-referred, under the worst of the bake's check lights",
              .columns = {"storage", "bytes a receiver", "PSNR, dB", "worst light"}};
  const auto add = [&](const std::string& name, const StoragePoint& point) {
    table.rows.push_back({name, fixed(point.bytes_per_receiver, 0), fixed(point.worst_psnr_db, 2),
                          point.worst_light});
  };
  add("bake", comparison.stored);
  // One row in so many: the picture has all.
  const std::size_t stride = std::max<std::size_t>(1, comparison.csr.size() / 8);
  for (std::size_t i = 0; i < comparison.csr.size(); i += stride) {
    add("float CSR", comparison.csr[i]);
  }
  section.remarks.push_back(
      "Float CSR of the bake's error takes " + fixed(comparison.csr_bytes_at_stored_error, 0) +
      " bytes a receiver, " +
      fixed(comparison.csr_bytes_at_stored_error / comparison.stored.bytes_per_receiver, 2) +
      " times as many.");
  section.tables.push_back(std::move(table));
  return section;
}

ReportSection section_of(const BrdfEditReport& report) {
  ReportSection section{
      .title = "BRDF curve edits",
      .question =
          "What each policy shows while curves are bent, for the terms that it may change, "
          "and what the image is off where the light or another curve made it stale."};
  Table runs{.caption = "Frames in which a curve changes",
             .columns = {"policy", "terms", "ms", "L2 error", "worst", "5 frames on", "to exact"}};
  for (const CurveRunSummary& run : summarize_curve_runs(report.rows)) {
    runs.rows.push_back({run.run, fixed(run.moving_terms, 1), fixed(run.median_ms, 3),
                         significant(run.moving_error_l2, 3), significant(run.worst_error_l2, 3),
                         significant(run.just_after_error_l2, 3),
                         run.frames_to_exact ? std::to_string(*run.frames_to_exact) : "-"});
  }
  Table stale{.caption = "T' is stale",
              .columns = {"by", "light", "quick ms", "L2 error", "estimate", "exact ms", "all ms"}};
  for (const StaleCurveRow& row : report.stale) {
    stale.rows.push_back({row.cause, row.light, fixed(row.quick_ms, 1),
                          significant(row.error_l2, 3), significant(row.estimate, 3),
                          fixed(row.exact_ms, 0), fixed(row.all_ms, 0)});
  }
  section.tables = {std::move(runs), std::move(stale)};
  return section;
}

ReportSection section_of(const std::vector<AdaptiveShRow>& rows) {
  ReportSection section{
      .title = "Spherical harmonics of vertices: adaptive products",
      .question =
          "What is calculated adaptively beside the full calculation, as fast as we can "
          "make that, under a light that turns."};
  Table table{.columns = {"mesh", "light", "degree", "visible", "full fps", "of peak", "policy",
                          "fps", "speed-up", "PSNR, dB", "diffuse", "specular", "flicker"}};
  for (const AdaptiveShRow& row : rows) {
    table.rows.push_back(
        {row.mesh, row.light, std::to_string(row.degree), std::to_string(row.visible),
         fixed(row.fps_full, 1), fixed(row.full_of_peak, 2), row.policy, fixed(row.fps_adaptive, 1),
         fixed(row.speedup, 2), fixed(row.psnr_db, 2), fixed(100 * row.filtered_diffuse, 0) + "%",
         fixed(100 * row.filtered_specular, 0) + "%", fixed(row.flicker, 4)});
  }
  const auto slow = std::ranges::count_if(
      rows, [](const AdaptiveShRow& row) { return !(row.full_of_peak >= kLeastFullOfPeak); });
  if (slow > 0) {
    section.remarks.push_back("In " + std::to_string(slow) +
                              " rows the full calculation is below " +
                              fixed(100 * kLeastFullOfPeak, 0) +
                              " % of peak: no measure, their speed-up is left out of the report.");
  }
  section.tables.push_back(std::move(table));
  return section;
}

ReportSection section_of(const std::vector<ShPolicyRow>& rows) {
  struct Sums {
    double error = 0, jump = 0, ms = 0;
    int count = 0;
  };
  std::map<std::vector<std::string>, Sums> by_run;
  for (const ShPolicyRow& row : rows) {
    if (!row.moving) continue;
    Sums& sums = by_run[{row.mesh, row.light, row.run}];
    sums.error += row.relative_l2;
    sums.jump = std::max(sums.jump, row.largest_jump);
    sums.ms += row.ms;
    ++sums.count;
  }
  ReportSection section{
      .title = "Spherical harmonics of vertices: policies",
      .question =
          "Irradiance under a light that turns when only 25 coefficients may change in a "
          "frame."};
  Table table{.caption = "Means of the frames in motion",
              .columns = {"mesh", "light", "run", "L2 error", "largest jump", "ms"}};
  for (const auto& [run, sums] : by_run) {
    std::vector<std::string> cells = run;
    cells.insert(cells.end(), {fixed(sums.error / sums.count, 5), fixed(sums.jump, 4),
                               fixed(sums.ms / sums.count, 3)});
    table.rows.push_back(std::move(cells));
  }
  section.tables.push_back(std::move(table));
  return section;
}

ReportSection section_of(const std::vector<StabilityRow>& rows) {
  ReportSection section{.title = "Stability at the extremes",
                        .question =
                            "What must hold where numbers, scenes and budgets are as they "
                            "seldom are: each case with its bound."};
  Table table{.columns = {"part", "case", "measured", "", "bound", "seconds", "", "note"}};
  for (const StabilityRow& row : rows) {
    const char* const relation = row.of->kind == BoundKind::at_most ? "at most" : "at least";
    table.rows.push_back({row.of->part, row.of->name, significant(row.measured.value, 3), relation,
                          significant(row.of->bound, 3), fixed(row.seconds, 2),
                          row.pass ? "" : "FAILED", row.measured.note});
    if (row.pass) continue;
    section.remarks.push_back(row.of->name + ": " + row.of->quantity + ": found " +
                              significant(row.measured.value, 6) + ", expected " + relation + " " +
                              significant(row.of->bound, 6) + " (" + row.of->why + ")");
  }
  section.tables.push_back(std::move(table));
  return section;
}

}  // namespace rimlight
