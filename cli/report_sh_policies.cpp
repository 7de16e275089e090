#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "cli/progress_bar.h"
#include "cli/report_experiments.h"
#include "cli/report_sources.h"
#include "core/base/parallel.h"
#include "core/light/light_sequence_source.h"
#include "core/report/report_sections.h"
#include "core/scene/default_scene.h"

namespace rimlight {
namespace {

struct Options {
  ReportOptions report;
  std::vector<std::string> meshes = {"vase"};
  std::vector<std::string> lights = {"studio", "cathedral", "sunny"};
  std::string sequence = "rotation";
  int degree = 19;
  int frames = 0;
};

int run(const Options& options) {
  if (options.report.threads > 0) set_thread_count(options.report.threads);
  const Scene builtin = default_scene();
  const ShPolicySettings settings = {find_light_sequence(options.sequence, "--sequence"),
                                     options.frames, default_sh_policy_runs()};
  std::vector<ShPolicyRow> rows;
  {
    ProgressBar bar("policies of spherical harmonics");
    for (const std::string& name : options.meshes) {
      const NamedMesh named = find_mesh(name, builtin);
      const LitMesh lit = light_mesh(named.name, named.meshes, options.degree);
      for (const std::string& light : options.lights) {
        const auto measured = measure_sh_policies(
            lit, *find_light(light), settings,
            [&](double share) { bar.show(named.name + " under " + light, share); });
        rows.insert(rows.end(), measured.begin(), measured.end());
      }
    }
  }
  MeasuredReport all = measured(std::move(rows));
  publish(all, options.report);
  return 0;
}

}  // namespace

void add_sh_policies_report(CLI::App& report, Action& chosen) {
  auto options = std::make_shared<Options>();
  CLI::App* const command = report.add_subcommand(
      "sh-policies",
      "Irradiance under a light that turns, 25 coefficients of spherical harmonics a frame: by "
      "band, by benefit, and the first 25 or 100 of them");
  add_output_options(*command, options->report);
  add_source_options(*command, options->meshes, options->lights);
  command->add_option("--degree", options->degree, "Of the harmonics")
      ->check(CLI::Range(1, sh::kLargestDegree))
      ->capture_default_str();
  command
      ->add_option("--sequence", options->sequence,
                   "A built-in light sequence that turns a light, or a file of one")
      ->capture_default_str();
  command->add_option("--frames", options->frames, "Of the sequence, from its first (default: all)")
      ->check(CLI::Range(1, 1 << 20));
  command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

}  // namespace rimlight
