#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "cli/progress_bar.h"
#include "cli/report_experiments.h"
#include "cli/report_sources.h"
#include "core/base/parallel.h"
#include "core/report/adaptive_sh_report.h"
#include "core/report/report_sections.h"
#include "core/scene/default_scene.h"

namespace rimlight {
namespace {

struct Options {
  ReportOptions report;
  std::vector<std::string> meshes = {"vase", "leaves"};
  std::vector<std::string> lights = {"studio", "cathedral"};
  AdaptiveShSettings settings;
};

int run(Options options) {
  if (options.report.threads > 0) set_thread_count(options.report.threads);
  const Scene builtin = default_scene();
  for (const std::string& mesh : options.meshes) {
    options.settings.meshes.push_back(find_mesh(mesh, builtin));
  }
  for (const std::string& light : options.lights) {
    options.settings.lights.push_back(find_light(light));
  }
  std::vector<AdaptiveShRow> rows;
  {
    ProgressBar bar("adaptive products");
    rows = measure_adaptive_sh(options.settings, [&bar](const std::string& stage, double share) {
      bar.show(stage, share);
    });
  }
  MeasuredReport all = measured(std::move(rows));
  publish(all, options.report);
  return 0;
}

}  // namespace

void add_adaptive_sh_report(CLI::App& report, Action& chosen) {
  auto options = std::make_shared<Options>();
  options->settings.degrees = {4, 6, 8, 10, 13};
  CLI::App* const command = report.add_subcommand(
      "adaptive-sh",
      "Light of vertices in spherical harmonics under a light that turns: adaptive calculations "
      "beside the full one");
  add_output_options(*command, options->report);
  AdaptiveShSettings& settings = options->settings;
  add_source_options(*command, options->meshes, options->lights);
  command->add_option("--degree", settings.degrees, "Of the harmonics; repeatable")
      ->check(CLI::Range(1, sh::kLargestDegree))
      ->capture_default_str();
  command
      ->add_option("--threshold", settings.threshold,
                   "Of multi-level filtering, as displayed (1 = white)")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  command
      ->add_option("--tolerance", settings.tolerance,
                   "Root mean square that view transport may leave out, as displayed")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

}  // namespace rimlight
