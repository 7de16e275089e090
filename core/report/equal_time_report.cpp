// What equal_time.h says in JSON, words and pictures.

#include <cmath>
#include <set>

#include "core/report/equal_time.h"
#include "core/report/report_files.h"

namespace rimlight {
namespace {

using nlohmann::json;

constexpr double kLevels[] = {30, 35, 40, 45};

/// In the order of the rows.
template <typename Field>
std::vector<std::string> names(const std::vector<EqualTimeRow>& rows, Field field) {
  std::vector<std::string> found;
  std::set<std::string> known;
  for (const EqualTimeRow& row : rows) {
    if (known.insert(row.*field).second) found.push_back(row.*field);
  }
  return found;
}

}  // namespace

json to_json(const EqualTimeReport& report) {
  json rows = json::array();
  for (const EqualTimeRow& row : report.rows) {
    json one = {{"light", row.light},
                {"method", row.method},
                {"steps", row.steps},
                {"ms", row.ms},
                {"psnr_db", row.psnr_db}};
    rows.push_back(std::move(one));
  }
  json summary = json::array();
  for (const std::string& light : names(report.rows, &EqualTimeRow::light)) {
    for (const std::string& method : names(report.rows, &EqualTimeRow::method)) {
      json one = {{"light", light}, {"method", method}};
      for (const double level : kLevels) {
        const auto ms = milliseconds_to(report, light, method, level);
        one["ms_to_" + fixed(level, 0) + "_db"] = ms ? json(*ms) : json(nullptr);
      }
      summary.push_back(std::move(one));
    }
  }
  return {{"experiment", "equal-time"},    {"machine", describe_machine()},
          {"scene", report.scene},         {"width", report.width},
          {"height", report.height},       {"bounces", report.bounces},
          {"cube_size", report.cube_size}, {"receivers", report.receivers},
          {"rows", std::move(rows)},       {"summary", std::move(summary)}};
}

ReportSection section_of(const EqualTimeReport& report) {
  ReportSection section{
      .title = "Beside a path tracer: " + report.scene,
      .question =
          "How long after a quarter turn of the light a picture is as good, relit from the "
          "bake and path traced anew with the same Embree."};
  section.remarks.push_back(std::to_string(report.width) + " x " + std::to_string(report.height) +
                            " pixels, " + std::to_string(report.bounces) + " bounces, " +
                            std::to_string(report.receivers) +
                            " receivers. Times of relighting have everything in them from the "
                            "light to the JPEG; those of path tracing only the paths.");
  Table table{.caption =
                  "Milliseconds until a display-referred PSNR against a path-traced truth; "
                  "and how many times as long path tracing takes for 40 dB"};
  table.columns = {"light", "method"};
  for (const double level : kLevels) table.columns.push_back(fixed(level, 0) + " dB");
  table.columns.push_back("x");
  for (const std::string& light : names(report.rows, &EqualTimeRow::light)) {
    const auto traced = milliseconds_to(report, light, kPathTracing, 40);
    for (const std::string& method : names(report.rows, &EqualTimeRow::method)) {
      std::vector<std::string> cells = {light, method};
      for (const double level : kLevels) {
        cells.push_back(fixed(milliseconds_to(report, light, method, level).value_or(NAN), 1));
      }
      const auto ours = milliseconds_to(report, light, method, 40);
      cells.push_back(ours && traced ? fixed(*traced / *ours, 1) : "-");
      table.rows.push_back(std::move(cells));
    }
  }
  section.tables.push_back(std::move(table));
  return section;
}

Figures draw_figures(const EqualTimeReport& report, const std::filesystem::path& folder) {
  Figures figures;
  int number = 0;
  for (const std::string& light : names(report.rows, &EqualTimeRow::light)) {
    const std::string picture = "equal-time-" + std::to_string(number++) + ".png";
    GnuplotScript script(picture);
    script.add("set title " +
               gnuplot_quote("After a quarter turn: " + report.scene + ", " + light));
    script.add("set xlabel \"milliseconds\"\nset logscale x\nset key outside right");
    script.add("set ylabel \"PSNR as displayed, dB\"");
    std::string plot;
    for (const std::string& method : names(report.rows, &EqualTimeRow::method)) {
      std::vector<std::vector<double>> points;
      for (const EqualTimeRow& row : report.rows) {
        if (row.light == light && row.method == method) points.push_back({row.ms, row.psnr_db});
      }
      if (points.empty()) continue;
      const std::string data = "d" + std::to_string(script.text().size());
      script.add_data(data, points);
      plot += (plot.empty() ? "plot $" : ", $") + data +
              " using 1:2 with linespoints lw 1.5 pt 7 ps 0.5 title " + gnuplot_quote(method);
    }
    script.add(plot);
    draw_figure(script, folder / picture, figures);
  }
  return figures;
}

}  // namespace rimlight
