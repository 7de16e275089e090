#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/progress_bar.h"
#include "cli/report_experiments.h"
#include "core/base/error.h"
#include "core/light/light_sequence_source.h"
#include "core/report/error_vs_time_json.h"
#include "core/report/figures.h"
#include "core/report/report_files.h"
#include "core/report/run_summary.h"

namespace rimlight {
namespace {

struct Options {
  ReportOptions report;
  std::vector<std::string> lights;
  std::string sequence = "rotation";
  std::vector<std::string> policies;
  int frames = 0;
};

/// An environment of the bake, one made by code, or a file.
std::shared_ptr<const Environment> find_light(const Bake& bake, const std::string& name) {
  for (const BakedEnvironment& one : bake.environments()) {
    if (one.environment->name() == name) return one.environment;
  }
  if (std::ranges::count(builtin_environment_names(), name) > 0) {
    return std::make_shared<const Environment>(builtin_environment(name));
  }
  const std::filesystem::path file(name);
  if (file.has_extension()) return std::make_shared<const Environment>(load_environment(file));
  std::string names;
  for (const auto& one : bake.environments()) names += " " + quote(one.environment->name());
  throw Error("--light", quote(name),
              "one of" + names + ", a built-in environment, or a .hdr or .exr file");
}

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

/// A table on standard error.
void print_summary(const ErrorVsTimeReport& report) {
  std::fprintf(stderr, "%-12s %-18s %8s %9s %8s   %s\n", "light", "policy", "ms", "L2 error",
               "PSNR dB", "still: L2 error");
  for (const RunSummary& run : summarize_runs(report.rows)) {
    std::fprintf(stderr, "%-12s %-18s %8.2f %9.4f %8.2f   %.4f\n", run.light.c_str(),
                 run.run.c_str(), run.moving.median_ms, run.moving.relative_l2, run.moving.psnr_db,
                 run.still.relative_l2);
  }
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
  if (!report.has_reference_rows) {
    std::fprintf(stderr,
                 "rimlight report: %s has no reference rows (bake --reference): errors are "
                 "against the stored transport, without compression's\n",
                 bake.folder().c_str());
  }
  print_summary(report);
  const auto draw = [&report](const std::filesystem::path& folder) {
    return draw_figures(report, folder);
  };
  publish(to_json(report), draw, options.report);
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
