#include <cstdio>
#include <system_error>

#include "cli/progress_bar.h"
#include "cli/report_experiments.h"
#include "core/bake/image_bake.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/report/report_files.h"
#include "core/scene/scene_source.h"

namespace rimlight {
namespace {

constexpr std::size_t kReferenceReceivers = 8192;

}  // namespace

void add_output_options(CLI::App& command, ReportOptions& options) {
  command.add_option("-o,--output", options.output, "Folder to write")->capture_default_str();
  command.add_option("--threads", options.threads, "Threads to use (default: all cores)")
      ->check(CLI::Range(1, 1024));
  command.add_flag("--json", options.json, "Print the report as one JSON object");
}

void add_report_options(CLI::App& command, ReportOptions& options) {
  command
      .add_option("--scene,scene", options.scene,
                  "Bake, best made with --reference; or a scene source (.json), which is baked "
                  "with reference rows first, into the output folder")
      ->required();
  add_output_options(command, options);
}

std::unique_ptr<const Bake> open_bake(const ReportOptions& options) {
  if (options.threads > 0) set_thread_count(options.threads);
  const std::filesystem::path source(options.scene);
  if (source.extension() != ".json") return std::make_unique<const Bake>(source);
  return bake_for_report(read_scene(source), options.output, source.stem().string()).bake;
}

ReportedBake bake_for_report(Scene scene, const std::filesystem::path& folder,
                             const std::string& name,
                             const std::function<void(const BakeProgress&)>& progress) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) throw Error(folder.string(), failure.message(), "a folder to write to");
  // What follows curves needs no rows to measure against: its exact image is summed anew.
  const bool of_curves = scene.bake.kind == BakeKind::brdf_curve;
  if (!of_curves) scene.bake.reference_receivers = kReferenceReceivers;
  const auto path = folder / (name + ".bake");
  const auto bake = of_curves ? bake_curves : bake_image;
  const BakeSummary summary = bake(std::make_shared<const Scene>(std::move(scene)), path, progress);
  return {std::make_unique<const Bake>(path), summary};
}

ReportedBake bake_for_report(Scene scene, const std::filesystem::path& folder,
                             const std::string& name) {
  ProgressBar bar("baking " + scene.name);
  return bake_for_report(std::move(scene), folder, name, [&bar](const BakeProgress& progress) {
    bar.show(progress.stage, progress.fraction, !progress.resumed);
  });
}

void publish(MeasuredReport& report, const ReportOptions& options) {
  ReportSection& section = report.section;
  for (const std::string& remark : section.remarks) {
    std::fprintf(stderr, "rimlight report: %s\n", remark.c_str());
  }
  for (const Table& table : section.tables) {
    std::fprintf(stderr, "%s\n", to_text(table).c_str());
  }
  write_report(report.json, options.output);
  const Figures figures = report.draw(options.output);
  if (figures.pictures.size() < figures.scripts.size()) {
    std::fprintf(stderr, "rimlight report: gnuplot is not installed: %zu scripts, no pictures\n",
                 figures.scripts.size());
  }
  section.pictures = figures.pictures;
  if (options.json) std::printf("%s\n", report.json.dump().c_str());
}

void add_report_command(CLI::App& app, Action& chosen) {
  CLI::App* const command =
      app.add_subcommand("report", "Run an experiment on a bake; write its numbers and figures");
  command->require_subcommand(1);
  add_adaptive_sh_report(*command, chosen);

  add_all_report(*command, chosen);
  add_brdf_edit_report(*command, chosen);
  add_codecs_report(*command, chosen);
  add_equal_time_report(*command, chosen);
  add_error_vs_time_report(*command, chosen);
  add_serving_report(*command, chosen);
  add_sh_policies_report(*command, chosen);
  add_stability_report(*command, chosen);
  add_storage_report(*command, chosen);
}

}  // namespace rimlight
