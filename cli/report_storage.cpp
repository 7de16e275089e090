#include <cstdio>

#include "cli/progress_bar.h"
#include "cli/report_experiments.h"
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
  std::fprintf(stderr,
               "%s: %.0f bytes a receiver, %.2f dB under its worst check light (%s); float CSR of "
               "that error: %.0f bytes, %.2f times as many\n",
               comparison.scene.c_str(), comparison.stored.bytes_per_receiver,
               comparison.stored.worst_psnr_db, comparison.stored.worst_light.c_str(),
               comparison.csr_bytes_at_stored_error,
               comparison.csr_bytes_at_stored_error / comparison.stored.bytes_per_receiver);
  const auto draw = [&comparison](const std::filesystem::path& folder) {
    return draw_figures(comparison, folder);
  };
  publish(to_json(comparison), draw, options);
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
