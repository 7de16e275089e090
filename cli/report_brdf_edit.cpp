#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "cli/progress_bar.h"
#include "cli/report_experiments.h"
#include "cli/report_sources.h"
#include "core/curves/curve_session_source.h"
#include "core/report/brdf_edit_report.h"
#include "core/report/report_sections.h"

namespace rimlight {
namespace {

struct Options {
  ReportOptions report;
  std::string light;
  std::string session = "pearl";
  std::vector<std::string> policies;
  int frames = 0;
};

BrdfEditSettings settings_of(const Options& options, const Bake& bake) {
  BrdfEditSettings settings{
      .session = find_curve_session(options.session, "--session"),
      .light = options.light.empty() ? nullptr : find_light(bake, options.light),
      .most_frames = options.frames};
  if (options.policies.empty()) return settings;
  settings.runs.clear();
  for (const std::string& policy : options.policies) {
    settings.runs.push_back(parse_curve_run(policy, "--policy"));
  }
  return settings;
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
  MeasuredReport all = measured(std::move(report));
  publish(all, options.report);
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
