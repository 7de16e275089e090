#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cli/progress_bar.h"
#include "cli/report_experiments.h"
#include "core/base/parallel.h"
#include "core/report/report_sections.h"
#include "core/report/stability.h"

namespace rimlight {
namespace {

constexpr std::size_t kMostEdits = 100'000'000;

struct Options {
  ReportOptions report;
  StabilitySettings settings;
  bool list = false;
};

/// The cases on standard output, a line each, without running them.
int print_list() {
  for (const StabilityCase& one : stability_cases()) {
    std::printf("%-16s %-30s %s, %s %.3g\n", one.part.c_str(), one.name.c_str(),
                one.quantity.c_str(), one.kind == BoundKind::at_most ? "at most" : "at least",
                one.bound);
  }
  return 0;
}

int run(const Options& options) {
  if (options.list) return print_list();
  if (options.report.threads > 0) set_thread_count(options.report.threads);
  std::vector<StabilityRow> rows;
  {
    ProgressBar bar("stability");
    rows = measure_stability(
        options.settings, [&bar](const std::string& name, double share) { bar.show(name, share); });
  }
  const bool all_pass = std::ranges::all_of(rows, &StabilityRow::pass);
  MeasuredReport all = measured(std::move(rows));
  publish(all, options.report);
  return all_pass ? 0 : 1;
}

}  // namespace

void add_stability_report(CLI::App& report, Action& chosen) {
  auto options = std::make_shared<Options>();
  CLI::App* const command = report.add_subcommand(
      "stability",
      "What must hold at the extremes, case by case: light, storage, drift, rotations, harmonics, "
      "bounces, fits, materials, geometry, denormals, receivers, budgets");
  add_output_options(*command, options->report);
  StabilitySettings& settings = options->settings;
  command->add_option("--case", settings.cases, "Only cases of these names; repeatable");
  command->add_option("--part", settings.parts, "Only cases of these parts; repeatable");
  command->add_option("--break", settings.broken,
                      "Disturb what this case measures, so that it fails: shows that it can; runs "
                      "it alone unless --case or --part choose more; repeatable");
  command->add_option("--edits", settings.trial.edits, "Edits of the cases about drift")
      ->check(CLI::Range(std::size_t{1}, kMostEdits))
      ->capture_default_str();
  command->add_flag("--fast", settings.trial.fast, "Fewer and smaller trials of every case");
  command->add_flag("--list", options->list, "Print the cases and their bounds; run none");
  command->footer(
      "Prints a table (standard error); writes stability.json and stability.csv, a row a case: "
      "case, part, quantity,\nbound, measured, pass, why (where the bound comes from), note.\n"
      "Exit status: 0 every case holds, 1 one does not.\n\n"
      "  rimlight report stability --json                     every case, about a minute\n"
      "  rimlight report stability --part rotation harmonics  two parts\n"
      "  rimlight report stability --part drift --edits 1000000\n"
      "  rimlight report stability --break single-lit-texel   fails: the case can see a fault");
  command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

}  // namespace rimlight
