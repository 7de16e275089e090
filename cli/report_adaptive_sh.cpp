#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "cli/progress_bar.h"
#include "cli/report_experiments.h"
#include "cli/report_sources.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/report/adaptive_sh_report.h"
#include "core/scene/default_scene.h"

namespace rimlight {
namespace {

struct Options {
  ReportOptions report;
  std::vector<std::string> meshes = {"vase", "leaves"};
  std::vector<std::string> lights = {"studio", "cathedral"};
  AdaptiveShSettings settings;
};

/// A table on standard error.
void print_rows(const std::vector<AdaptiveShRow>& rows) {
  std::fprintf(stderr, "%-12s %-14s %6s %8s %9s %5s  %-11s %9s %8s %7s %9s %8s %8s\n", "mesh",
               "light", "degree", "visible", "full fps", "peak", "policy", "fps", "speedup", "PSNR",
               "diffuse", "specular", "flicker");
  for (const AdaptiveShRow& row : rows) {
    std::fprintf(
        stderr, "%-12s %-14s %6d %8zu %9.1f %5.2f  %-11s %9.1f %8.2f %7.2f %8.0f%% %7.0f%% %8.4f\n",
        row.mesh.c_str(), row.light.c_str(), row.degree, row.visible, row.fps_full,
        row.full_of_peak, row.policy.c_str(), row.fps_adaptive, row.speedup, row.psnr_db,
        100 * row.filtered_diffuse, 100 * row.filtered_specular, row.flicker);
  }
  const auto slow = std::ranges::count_if(
      rows, [](const AdaptiveShRow& row) { return !(row.full_of_peak >= kLeastFullOfPeak); });
  if (slow > 0) {
    std::fprintf(stderr,
                 "rimlight report: in %td rows the full calculation is below %.0f %% of peak: no "
                 "measure, their speed-up is left out of the report\n",
                 slow, 100 * kLeastFullOfPeak);
  }
}

int run(Options options) {
  if (options.report.threads > 0) set_thread_count(options.report.threads);
  const Scene builtin = default_scene();
  for (const std::string& mesh : options.meshes) {
    options.settings.meshes.push_back(find_mesh(mesh, builtin));
  }
  for (const std::string& light : options.lights) {
    options.settings.lights.push_back(find_light(light));
  }
  std::error_code failure;
  std::filesystem::create_directories(options.report.output, failure);
  if (failure) throw Error(options.report.output, failure.message(), "a folder to write to");
  std::vector<AdaptiveShRow> rows;
  {
    ProgressBar bar("adaptive products");
    rows = measure_adaptive_sh(options.settings, [&bar](const std::string& stage, double share) {
      bar.show(stage, share);
    });
  }
  print_rows(rows);
  publish(
      to_json(rows),
      [&rows](const std::filesystem::path& folder) { return draw_figures(rows, folder); },
      options.report);
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
