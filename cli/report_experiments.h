#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "cli/command.h"
#include "core/bake/transport_bake.h"
#include "core/report/gnuplot.h"
#include "core/report/report_page.h"
#include "core/scene/scene.h"
#include "core/transport/bake_folder.h"

namespace rimlight {

/// What every experiment of `rimlight report` takes.
struct ReportOptions {
  std::string scene;  // a bake, or a scene source to bake first
  std::string output = "report";
  int threads = 0;
  bool json = false;
};

/// Adds those options to an experiment's command; or those but the scene, where it needs no bake.
void add_output_options(CLI::App& command, ReportOptions& options);
void add_report_options(CLI::App& command, ReportOptions& options);

/// Sets the threads and opens the bake; a scene source is baked first, with reference rows, into
/// the output folder.
/// Throws Error.
std::unique_ptr<const Bake> open_bake(const ReportOptions& options);
struct ReportedBake {
  std::unique_ptr<const Bake> bake;
  BakeSummary summary;
};
/// Bakes a scene with reference rows, or without where the kind needs none, to FOLDER/NAME.bake,
/// and opens that. Throws Error.
ReportedBake bake_for_report(Scene scene, const std::filesystem::path& folder,
                             const std::string& name,
                             const std::function<void(const BakeProgress&)>& progress);
/// The same with a progress bar.
ReportedBake bake_for_report(Scene scene, const std::filesystem::path& folder,
                             const std::string& name);

/// What an experiment measured, in all the forms that it is told in.
struct MeasuredReport {
  nlohmann::json json;
  ReportSection section;
  std::function<Figures(const std::filesystem::path& folder)> draw;
};

/// Of a report that has to_json(), section_of() and draw_figures().
template <typename Report>
MeasuredReport measured(Report report) {
  const auto kept = std::make_shared<const Report>(std::move(report));
  return {to_json(*kept), section_of(*kept),
          [kept](const std::filesystem::path& folder) { return draw_figures(*kept, folder); }};
}

/// Prints its tables to standard error, writes its files to the output folder, made if need be,
/// draws its figures, which the section has then, and prints its JSON where that is asked for. Says
/// when figures could not be drawn. Throws Error.
void publish(MeasuredReport& report, const ReportOptions& options);

/// All of them, to one page.
void add_all_report(CLI::App& report, Action& chosen);
// One function an experiment.
void add_adaptive_sh_report(CLI::App& report, Action& chosen);
void add_brdf_edit_report(CLI::App& report, Action& chosen);
void add_codecs_report(CLI::App& report, Action& chosen);
void add_equal_time_report(CLI::App& report, Action& chosen);
void add_error_vs_time_report(CLI::App& report, Action& chosen);
void add_serving_report(CLI::App& report, Action& chosen);
void add_sh_policies_report(CLI::App& report, Action& chosen);
void add_stability_report(CLI::App& report, Action& chosen);
void add_storage_report(CLI::App& report, Action& chosen);

}  // namespace rimlight
