#include "core/report/adaptive_sh_report.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "core/report/report_files.h"

namespace rimlight {
namespace {

using nlohmann::json;

json row_json(const AdaptiveShRow& row) {
  json speedup = nullptr, view_ms = nullptr;
  if (row.full_of_peak >= kLeastFullOfPeak) speedup = row.speedup;
  if (row.view_ms > 0) view_ms = row.view_ms;
  return {{"mesh", row.mesh},
          {"light", row.light},
          {"policy", row.policy},
          {"degree", row.degree},
          {"coefficients", row.coefficients},
          {"vertices", row.vertices},
          {"visible", row.visible},
          {"fps_full", row.fps_full},
          {"full_of_peak", row.full_of_peak},
          {"fps_adaptive", row.fps_adaptive},
          {"speedup", speedup},
          {"psnr_db", row.psnr_db},
          {"least_psnr_db", row.least_psnr_db},
          {"filtered_diffuse", row.filtered_diffuse},
          {"filtered_specular", row.filtered_specular},
          {"flicker", row.flicker},
          {"view_ms", view_ms},
          {"fps_view_moves", row.fps_view_moves}};
}

/// Lines of one picture: coefficients and frames a second, by what is calculated.
using Lines = std::map<std::string, std::vector<std::vector<double>>>;

void add_point(const AdaptiveShRow& row, Lines& lines) {
  const auto coefficients = static_cast<double>(row.coefficients);
  lines[row.policy].push_back({coefficients, row.fps_adaptive});
  auto& full = lines["full"];
  if (std::ranges::none_of(full, [&](const auto& point) { return point[0] == coefficients; })) {
    full.push_back({coefficients, row.fps_full});
  }
}

}  // namespace

json to_json(std::span<const AdaptiveShRow> rows) {
  json list = json::array();
  for (const AdaptiveShRow& row : rows) list.push_back(row_json(row));
  return {{"experiment", "adaptive-sh"}, {"machine", describe_machine()}, {"rows", list}};
}

Figures draw_figures(std::span<const AdaptiveShRow> rows, const std::filesystem::path& folder) {
  std::map<std::pair<std::string, std::string>, Lines> pictures;
  for (const AdaptiveShRow& row : rows) add_point(row, pictures[{row.mesh, row.light}]);
  Figures figures;
  for (auto& [names, lines] : pictures) {
    const auto& [mesh, light] = names;
    const std::filesystem::path picture = "adaptive-sh-" + mesh + "-" + light + ".png";
    GnuplotScript script(picture.string());
    script.add("set title " + gnuplot_quote("Light of visible vertices: " + mesh + ", " + light));
    script.add("set xlabel \"coefficients\"\nset ylabel \"frames a second\"");
    script.add("set logscale y\nset key top right");
    std::string plot;
    int number = 0;
    for (auto& [name, points] : lines) {
      std::ranges::sort(points);
      const std::string data = "line" + std::to_string(number++);
      script.add_data(data, points);
      plot += (plot.empty() ? "plot $" : ", $") + data +
              " using 1:2 with linespoints lw 1.5 title " + gnuplot_quote(name);
    }
    script.add(plot);
    draw_figure(script, folder / picture, figures);
  }
  return figures;
}

}  // namespace rimlight
