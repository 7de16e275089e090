#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "cli/progress_bar.h"
#include "cli/report_experiments.h"
#include "cli/report_sources.h"
#include "core/curves/curve_session_source.h"
#include "core/report/brdf_edit_report.h"
#include "core/report/brdf_edit_summary.h"

namespace rimlight {
namespace {

struct Options {
  ReportOptions report;
  std::string light;
  std::string session = "pearl";
  std::vector<std::string> policies;
  int frames = 0;
};

/// An environment of the bake, or what find_light() finds.
std::shared_ptr<const Environment> light_of(const Bake& bake, const std::string& name) {
  if (name.empty()) return nullptr;
  for (const BakedEnvironment& one : bake.environments()) {
    if (one.environment->name() == name) return one.environment;
  }
  return find_light(name);
}

BrdfEditSettings settings_of(const Options& options, const Bake& bake) {
  BrdfEditSettings settings{.session = find_curve_session(options.session, "--session"),
                            .light = light_of(bake, options.light),
                            .most_frames = options.frames};
  if (options.policies.empty()) return settings;
  settings.runs.clear();
  for (const std::string& policy : options.policies) {
    settings.runs.push_back(parse_curve_run(policy, "--policy"));
  }
  return settings;
}

/// Tables on standard error.
void print_summary(const BrdfEditReport& report) {
  std::fprintf(stderr, "%-16s %8s %10s %12s %12s %12s %9s\n", "policy", "terms", "ms", "L2 error",
               "worst", "5 frames on", "to exact");
  for (const CurveRunSummary& run : summarize_curve_runs(report.rows)) {
    const std::string frames = run.frames_to_exact ? std::to_string(*run.frames_to_exact) : "-";
    std::fprintf(stderr, "%-16s %8.1f %10.3f %12.3g %12.3g %12.3g %9s\n", run.run.c_str(),
                 run.moving_terms, run.median_ms, run.moving_error_l2, run.worst_error_l2,
                 run.just_after_error_l2, frames.c_str());
  }
  std::fprintf(stderr, "\n%-12s %-12s %10s %12s %10s %10s %10s\n", "T' stale by", "light",
               "quick ms", "L2 error", "estimate", "exact ms", "all ms");
  for (const StaleCurveRow& row : report.stale) {
    std::fprintf(stderr, "%-12s %-12s %10.1f %12.3g %10.3g %10.0f %10.0f\n", row.cause.c_str(),
                 row.light.c_str(), row.quick_ms, row.error_l2, row.estimate, row.exact_ms,
                 row.all_ms);
  }
}

int run(const Options& options) {
  const std::shared_ptr<const Bake> bake = open_bake(options.report);
  const BrdfEditSettings settings = settings_of(options, *bake);
  BrdfEditReport report;
  {
    ProgressBar bar("curve edits");
    report = measure_brdf_edit(
        bake, settings, [&bar](const std::string& stage, double share) { bar.show(stage, share); });
  }
  print_summary(report);
  const auto draw = [&report](const std::filesystem::path& folder) {
    return draw_figures(report, folder);
  };
  publish(to_json(report), draw, options.report);
  return 0;
}

}  // namespace

void add_brdf_edit_report(CLI::App& report, Action& chosen) {
  auto options = std::make_shared<Options>();
  CLI::App* const command = report.add_subcommand(
      "brdf-edit",
      "Play a recorded session of curve edits on a bake of kind brdf_curve through every policy "
      "and budget; measure time and error of each frame, and what a stale T' costs");
  add_report_options(*command, options->report);
  command
      ->add_option("--session", options->session,
                   "A session of curve edits by name, or a .json file")
      ->capture_default_str();
  command->add_option("--light", options->light,
                      "An environment of the bake or a built-in one by name, or a .hdr or .exr "
                      "file (default: the bake's first)");
  command->add_option("--policy", options->policies,
                      "nwa, bi or benefit @ terms, bytes or milliseconds: bi@30, benefit@16ms, "
                      "nwa@4MB; repeatable (default: all with many budgets)");
  command->add_option("--frames", options->frames, "Only the first of the session")
      ->check(CLI::Range(1, 1'000'000));
  command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

}  // namespace rimlight
