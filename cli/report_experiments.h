#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/command.h"
#include "core/report/gnuplot.h"
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

/// Writes a report's files, draws its figures, prints it where --json asks for it, and says when
/// figures could not be drawn. Throws Error.
void publish(const nlohmann::json& report,
             const std::function<Figures(const std::filesystem::path& folder)>& draw,
             const ReportOptions& options);

// One function an experiment.
void add_adaptive_sh_report(CLI::App& report, Action& chosen);
void add_brdf_edit_report(CLI::App& report, Action& chosen);
void add_error_vs_time_report(CLI::App& report, Action& chosen);
void add_sh_policies_report(CLI::App& report, Action& chosen);
void add_stability_report(CLI::App& report, Action& chosen);
void add_storage_report(CLI::App& report, Action& chosen);

}  // namespace rimlight
