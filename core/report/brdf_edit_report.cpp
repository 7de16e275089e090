#include "core/report/brdf_edit_report.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "core/report/brdf_edit_summary.h"
#include "core/report/report_files.h"

namespace rimlight {
namespace {

using nlohmann::json;

/// What one figure shows of a run over time.
constexpr const char* kShownBudget = "30";

std::string axis_name(CurveAxis axis) {
  return axis == CurveAxis::half_angle ? "half_angle" : "difference_angle";
}

/// A number of terms, or "16ms", "4MB".
json budget_json(const std::string& budget) {
  const bool is_count = budget.find_first_not_of("0123456789") == std::string::npos;
  return is_count ? json(std::stoull(budget)) : json(budget);
}

json row_json(const BrdfEditReport& report, const CurveFrameRow& row) {
  const CurveStroke& stroke = report.session.strokes[row.stroke];
  return {{"scene", report.scene},
          {"light", report.light},
          {"session", report.session.name},
          {"edit", stroke.title},
          {"material", stroke.material},
          {"axis", axis_name(stroke.axis)},
          {"run", row.run},
          {"policy", row.policy},
          {"budget", budget_json(row.budget)},
          {"frame", row.frame},
          {"moving", row.moving},
          {"frames_since_edit", row.frames_since_edit},
          {"ms", row.ms()},
          {"plan_ms", row.plan_ms},
          {"apply_ms", row.apply_ms},
          {"terms", row.terms},
          {"bytes", row.bytes},
          {"error_l2", row.error_l2},
          {"estimate", row.estimate},
          {"exact", row.exact}};
}

json summary_json(const CurveRunSummary& summary) {
  json frames_to_exact = nullptr;
  if (summary.frames_to_exact) frames_to_exact = *summary.frames_to_exact;
  return {{"run", summary.run},
          {"policy", summary.policy},
          {"budget", budget_json(summary.budget)},
          {"moving_error_l2", summary.moving_error_l2},
          {"worst_error_l2", summary.worst_error_l2},
          {"last_moving_error_l2", summary.last_moving_error_l2},
          {"just_after_error_l2", summary.just_after_error_l2},
          {"moving_terms", summary.moving_terms},
          {"median_ms", summary.median_ms},
          {"frames_to_exact", frames_to_exact}};
}

json stroke_json(const CurveStroke& stroke, const StrokeReport& report) {
  return {{"edit", stroke.title},
          {"material", stroke.material},
          {"axis", axis_name(stroke.axis)},
          {"first_frame", report.first_frame},
          {"transport_ms", report.transport_ms},
          {"norms_ms", report.norms_ms},
          {"stored_l2", report.stored_l2}};
}

json stale_json(const StaleCurveRow& row) {
  return {{"cause", row.cause},       {"light", row.light},       {"quick_ms", row.quick_ms},
          {"error_l2", row.error_l2}, {"estimate", row.estimate}, {"exact_ms", row.exact_ms},
          {"all_ms", row.all_ms}};
}

/// Points of a picture's lines, by policy.
using Lines = std::map<std::string, std::vector<std::vector<double>>>;

/// `settings`: axes.
void draw_lines(const std::string& name, const std::string& settings, const Lines& lines,
                const std::filesystem::path& folder, Figures& figures) {
  const std::string picture = "brdf-edit-" + name + ".png";
  GnuplotScript script(picture);
  script.add(settings + "\nset logscale y\nset key outside right");
  script.add("set ylabel \"error, L2, relative\"");
  std::string plot;
  for (const auto& [policy, points] : lines) {
    const std::string data = "d_" + policy;
    script.add_data(data, points);
    plot += (plot.empty() ? "plot $" : ", $") + data + " using 1:2 with linespoints pt 7 ps 0.4 " +
            "title " + gnuplot_quote(policy);
  }
  if (plot.empty()) return;
  script.add(plot);
  draw_figure(script, folder / picture, figures);
}

std::string title(const BrdfEditReport& report, const std::string& what) {
  return "set title " + gnuplot_quote(what + ": session " + report.session.name + ", " +
                                      report.scene + ", " + report.light);
}

}  // namespace

json to_json(const BrdfEditReport& report) {
  json result = {{"experiment", "brdf-edit"},      {"machine", describe_machine()},
                 {"scene", report.scene},          {"light", report.light},
                 {"session", report.session.name}, {"cube_size", report.cube_size},
                 {"receivers", report.row_count},  {"panels", report.panel_count},
                 {"rows", json::array()},          {"summary", json::array()},
                 {"edits", json::array()},         {"stale", json::array()}};
  for (const CurveFrameRow& row : report.rows) result["rows"].push_back(row_json(report, row));
  for (const CurveRunSummary& summary : summarize_curve_runs(report.rows)) {
    result["summary"].push_back(summary_json(summary));
  }
  for (std::size_t s = 0; s < report.strokes.size(); ++s) {
    result["edits"].push_back(stroke_json(report.session.strokes[s], report.strokes[s]));
  }
  for (const StaleCurveRow& row : report.stale) result["stale"].push_back(stale_json(row));
  return result;
}

Figures draw_figures(const BrdfEditReport& report, const std::filesystem::path& folder) {
  Lines frames, terms, times;
  for (const CurveFrameRow& row : report.rows) {
    // What is exact has no place on a logarithmic axis.
    if (row.budget != kShownBudget || !(row.error_l2 > 0)) continue;
    frames[row.policy].push_back({static_cast<double>(row.frame), row.error_l2});
  }
  for (const CurveRunSummary& run : summarize_curve_runs(report.rows)) {
    if (!(run.moving_error_l2 > 0)) continue;
    times[run.policy].push_back({run.median_ms, run.moving_error_l2});
    if (budget_json(run.budget).is_number()) {
      terms[run.policy].push_back({std::stod(run.budget), run.moving_error_l2});
    }
  }
  for (Lines* const lines : {&terms, &times}) {
    for (auto& [policy, points] : *lines) std::ranges::sort(points);
  }
  Figures figures;
  draw_lines("error",
             title(report, std::string("Error with ") + kShownBudget + " terms a frame") +
                 "\nset xlabel \"frame\"",
             frames, folder, figures);
  draw_lines("error-vs-terms",
             title(report, "Error of frames in motion, mean") +
                 "\nset xlabel \"terms a frame\"\nset logscale x",
             terms, folder, figures);
  draw_lines("error-vs-ms",
             title(report, "Error of frames in motion, mean, against their time") +
                 "\nset xlabel \"median milliseconds of a frame\"",
             times, folder, figures);
  return figures;
}

}  // namespace rimlight
