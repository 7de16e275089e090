#include "core/report/storage_report.h"

#include <cmath>
#include <string>

#include "core/report/report_files.h"

namespace rimlight {
namespace {

using nlohmann::json;

/// Worse or better than anyone asks of a bake: left out of the figure.
constexpr double kLeastShownDb = 20, kMostShownDb = 90;

json point_json(const StorageComparison& comparison, const char* storage,
                const StoragePoint& point) {
  return {{"scene", comparison.scene},
          {"storage", storage},
          {"bytes_per_receiver", point.bytes_per_receiver},
          {"worst_psnr_db", point.worst_psnr_db},
          {"worst_light", point.worst_light}};
}

}  // namespace

json to_json(const StorageComparison& comparison) {
  json rows = json::array();  // braces around one object mean an array to some compilers only
  rows.push_back(point_json(comparison, "bake", comparison.stored));
  for (const StoragePoint& point : comparison.csr) {
    rows.push_back(point_json(comparison, "float CSR", point));
  }
  json ratio = nullptr, csr_bytes = nullptr;
  if (std::isfinite(comparison.csr_bytes_at_stored_error)) {
    csr_bytes = comparison.csr_bytes_at_stored_error;
    ratio = comparison.stored.bytes_per_receiver / comparison.csr_bytes_at_stored_error;
  }
  return {{"experiment", "storage"},
          {"machine", describe_machine()},
          {"scene", comparison.scene},
          {"cube_size", comparison.cube_size},
          {"receivers", comparison.receivers},
          {"rows", rows},
          {"csr_bytes_at_the_bakes_error", csr_bytes},
          {"bake_over_csr", ratio}};
}

Figures draw_figures(const StorageComparison& comparison, const std::filesystem::path& folder) {
  std::vector<std::vector<double>> curve;
  for (const StoragePoint& point : comparison.csr) {
    if (point.worst_psnr_db < kLeastShownDb || point.worst_psnr_db > kMostShownDb) continue;
    curve.push_back({point.worst_psnr_db, point.bytes_per_receiver});
  }
  const std::filesystem::path picture = "storage.png";
  GnuplotScript script(picture.string());
  script.add("set title " + gnuplot_quote("Storage: " + comparison.scene + ", 6 × " +
                                          std::to_string(comparison.cube_size) + "² directions"));
  script.add("set xlabel \"display-referred PSNR under the worst check light, dB\"");
  script.add("set ylabel \"bytes a receiver\"\nset logscale y\nset key top left");
  script.add_data("bake",
                  {{comparison.stored.worst_psnr_db, comparison.stored.bytes_per_receiver}});
  std::string plot = "plot $bake using 1:2 with points pt 7 ps 2 title \"this bake\"";
  if (!curve.empty()) {
    script.add_data("csr", curve);
    plot += ", $csr using 1:2 with lines lw 1.5 title \"float CSR, one threshold\"";
  }
  script.add(plot);
  Figures figures;
  draw_figure(script, folder / picture, figures);
  return figures;
}

}  // namespace rimlight
