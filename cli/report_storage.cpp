#include "cli/progress_bar.h"
#include "cli/report_experiments.h"
#include "core/report/report_sections.h"
#include "core/report/storage_report.h"

namespace rimlight {
namespace {

int run(const ReportOptions& options) {
  const std::unique_ptr<const Bake> bake = open_bake(options);
  StorageComparison comparison;
  {
    ProgressBar bar("storage");
    comparison = compare_storage(
        *bake, [&bar](double share) { bar.show("pruning the reference rows", share); });
  }
  MeasuredReport all = measured(std::move(comparison));
  publish(all, options);
  return 0;
}

}  // namespace

void add_storage_report(CLI::App& report, Action& chosen) {
  auto options = std::make_shared<ReportOptions>();
  CLI::App* const command = report.add_subcommand(
      "storage",
      "What a bake's storage is worth: bytes against error, beside compressed sparse rows pruned "
      "by one threshold");
  add_report_options(*command, *options);
  command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

}  // namespace rimlight
