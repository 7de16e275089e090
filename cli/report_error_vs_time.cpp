#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/progress_bar.h"
#include "cli/report_experiments.h"
#include "cli/report_sources.h"
#include "core/base/error.h"
#include "core/light/light_sequence_source.h"
#include "core/report/error_vs_time_json.h"
#include "core/report/figures.h"
#include "core/report/report_sections.h"

namespace rimlight {
namespace {

struct Options {
  ReportOptions report;
  std::vector<std::string> lights;
  std::string sequence = "rotation";
  std::vector<std::string> policies;
  int frames = 0;
};

ErrorVsTimeSettings settings_of(const Options& options, const Bake& bake) {
  ErrorVsTimeSettings settings;
  settings.sequence = find_light_sequence(options.sequence, "--sequence");
  settings.most_frames = options.frames;
  for (const std::string& light : options.lights) {
    settings.lights.push_back(find_light(bake, light));
  }
  if (options.policies.empty()) return settings;
  settings.policies.clear();
  for (const std::string& policy : options.policies) {
    settings.policies.push_back(parse_timed_policy(policy, "--policy"));
  }
  return settings;
}

int run(const Options& options) {
  const std::unique_ptr<const Bake> opened = open_bake(options.report);
  const Bake& bake = *opened;
  const ErrorVsTimeSettings settings = settings_of(options, bake);
  ErrorVsTimeReport report;
  {
    ProgressBar bar("error against time");
    report = measure_error_vs_time(
        bake, settings, [&bar](const std::string& stage, double share) { bar.show(stage, share); });
  }
  MeasuredReport all = measured(std::move(report));
  publish(all, options.report);
  return 0;
}

}  // namespace

void add_error_vs_time_report(CLI::App& report, Action& chosen) {
  auto options = std::make_shared<Options>();
  CLI::App* const command = report.add_subcommand(
      "error-vs-time",
      "Play a light sequence through every policy and budget; measure time and error of each "
      "frame");
  add_report_options(*command, options->report);
  command->add_option("--light", options->lights,
                      "An environment of the bake or a built-in one by name, or a .hdr or .exr "
                      "file; repeatable (default: the bake's own)");
  command->add_option("--sequence", options->sequence, "A light sequence by name, or a .json file")
      ->capture_default_str();
  command->add_option("--policy", options->policies,
                      "POLICY@BUDGET, such as pbi@30 or benefit@16ms; or as long as another takes, "
                      "benefit@pbi@30, or as many bytes, benefit@bytes:pbi@30; repeatable "
                      "(default: those of the papers, and "
                      "benefit in their time)");
  command->add_option("--frames", options->frames, "Only the first of the sequence")
      ->check(CLI::Range(1, 1'000'000));
  command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

}  // namespace rimlight
