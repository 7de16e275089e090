#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "cli/progress_bar.h"
#include "cli/report_experiments.h"
#include "cli/report_sources.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/report/equal_time.h"
#include "core/scene/scene_source.h"

namespace rimlight {
namespace {

struct Options {
  ReportOptions report;
  std::string bake;
  std::vector<std::string> lights;
  std::vector<std::string> policies = {"benefit@8ms", "benefit@16ms"};
  EqualTimeSettings settings;
};

int run(Options options) {
  if (options.report.threads > 0) set_thread_count(options.report.threads);
  const std::filesystem::path source(options.report.scene);
  const auto scene = std::make_shared<const Scene>(read_scene(source));
  if (scene->bake.kind != BakeKind::image_haar) {
    throw Error(source.string(), "a bake of another kind", "one of kind image_haar");
  }
  const auto bake =
      options.bake.empty()
          ? bake_for_report(*scene, options.report.output, source.stem().string()).bake
          : std::make_unique<const Bake>(options.bake);
  for (const std::string& light : options.lights) {
    options.settings.lights.push_back(find_light(*bake, light));
  }
  for (const std::string& policy : options.policies) {
    options.settings.policies.push_back(parse_timed_policy(policy, "--policy"));
  }
  EqualTimeReport report;
  {
    ProgressBar bar("equal time");
    report = measure_equal_time(
        scene, *bake, options.settings,
        [&bar](const std::string& stage, double share) { bar.show(stage, share); });
  }
  MeasuredReport all = measured(std::move(report));
  publish(all, options.report);
  return 0;
}

}  // namespace

void add_equal_time_report(CLI::App& report, Action& chosen) {
  auto options = std::make_shared<Options>();
  CLI::App* const command = report.add_subcommand("equal-time",
                                                  "How good a picture is so long after the light "
                                                  "has turned: relit from a bake, and path traced "
                                                  "anew with the same Embree");
  command->add_option("--scene,scene", options->report.scene, "Scene source (.json)")->required();
  command->add_option("--bake", options->bake,
                      "A bake of that scene (default: it is baked into the output folder)");
  add_output_options(*command, options->report);
  command->add_option("--light", options->lights,
                      "An environment of the bake or a built-in one by name, or a .hdr or .exr "
                      "file; repeatable (default: the bake's own)");
  command->add_option("--policy", options->policies, "POLICY@MILLISECONDS; repeatable")
      ->capture_default_str();
  command
      ->add_option("--seconds", options->settings.seconds,
                   "Of path tracing for each light, and as many again for the truth")
      ->check(CLI::Range(0.01, 36'000.0))
      ->capture_default_str();
  command->add_option("--frames", options->settings.frames, "Of each policy after the turn")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

}  // namespace rimlight
