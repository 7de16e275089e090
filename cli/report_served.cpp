// The experiments on what is served: codecs, and crowds of clients.

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/codec_report.h"
#include "cli/progress_bar.h"
#include "cli/report_experiments.h"
#include "cli/serving_report.h"

namespace rimlight {
namespace {

struct Options {
  ReportOptions report;
  int pictures = 10;
  double seconds = 8;
};

int run_codecs(const Options& options) {
  const std::shared_ptr<const Bake> bake = open_bake(options.report);
  ProgressBar bar("codecs");
  MeasuredReport all = measured(
      measure_codecs(bake, options.pictures,
                     [&bar](const std::string& stage, double share) { bar.show(stage, share); }));
  publish(all, options.report);
  return 0;
}

int run_serving(const Options& options) {
  const std::filesystem::path bake = open_bake(options.report)->folder();
  ProgressBar bar("serving");
  MeasuredReport all = measured(
      measure_serving(bake, options.seconds,
                      [&bar](const std::string& stage, double share) { bar.show(stage, share); }));
  publish(all, options.report);
  return 0;
}

}  // namespace

void add_codecs_report(CLI::App& report, Action& chosen) {
  auto options = std::make_shared<Options>();
  CLI::App* const command = report.add_subcommand(
      "codecs", "Bytes, time and error of every way in which a client may get a frame");
  add_report_options(*command, options->report);
  command->add_option("--pictures", options->pictures, "Exact pictures to encode")
      ->check(CLI::Range(2, 1000))
      ->capture_default_str();
  command->callback([options, &chosen] { chosen = [options] { return run_codecs(*options); }; });
}

void add_serving_report(CLI::App& report, Action& chosen) {
  auto options = std::make_shared<Options>();
  CLI::App* const command = report.add_subcommand(
      "serving", "Crowds of scripted clients on a server in this process: frames and latencies");
  add_report_options(*command, options->report);
  command->add_option("--seconds", options->seconds, "Of each crowd")
      ->check(CLI::Range(0.5, 3600.0))
      ->capture_default_str();
  command->callback([options, &chosen] { chosen = [options] { return run_serving(*options); }; });
}

}  // namespace rimlight
