// What equal_time.h says in JSON, words and pictures.

#include <algorithm>
#include <cmath>
#include <set>

#include "core/report/equal_time.h"
#include "core/report/report_files.h"

namespace rimlight {
namespace {

using nlohmann::json;

constexpr double kLevels[] = {30, 35, 40, 45};

bool are_alike(const EqualTimeRow& a, const EqualTimeRow& b) {
  return a.light == b.light && a.method == b.method && a.against == b.against;
}

/// The last row of each light, method and picture: what it came to.
std::vector<EqualTimeRow> last_rows(const std::vector<EqualTimeRow>& rows) {
  std::vector<EqualTimeRow> last;
  for (const EqualTimeRow& row : rows) {
    const auto found =
        std::ranges::find_if(last, [&](const EqualTimeRow& one) { return are_alike(one, row); });
    if (found == last.end()) {
      last.push_back(row);
    } else {
      *found = row;
    }
  }
  return last;
}

}  // namespace

json to_json(const EqualTimeReport& report) {
  json rows = json::array();
  for (const EqualTimeRow& row : report.rows) {
    json one = {{"light", row.light}, {"method", row.method}, {"against", row.against},
                {"steps", row.steps}, {"ms", row.ms},         {"psnr_db", row.psnr_db}};
    rows.push_back(std::move(one));
  }
  json summary = json::array();
  for (const EqualTimeRow& last : last_rows(report.rows)) {
    json one = {{"light", last.light},
                {"method", last.method},
                {"against", last.against},
                {"last_psnr_db", last.psnr_db}};
    for (const double level : kLevels) {
      const auto ms = milliseconds_to(report, last, level);
      one["ms_to_" + fixed(level, 0) + "_db"] = ms ? json(*ms) : json(nullptr);
    }
    summary.push_back(std::move(one));
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
  section.remarks.push_back(
      "Path tracing is held against a picture that was traced with other seeds for as long, "
      "without "
      "that one's noise; relighting against the picture that the bake comes to, and against the "
      "traced one, from which the bake's own noise keeps it.");
  Table table{.caption =
                  "Milliseconds until a display-referred PSNR; how many times as long path "
                  "tracing takes for 40 dB; the last PSNR"};
  table.columns = {"light", "method", "against"};
  for (const double level : kLevels) table.columns.push_back(fixed(level, 0) + " dB");
  table.columns.insert(table.columns.end(), {"x", "last, dB"});
  for (const EqualTimeRow& last : last_rows(report.rows)) {
    std::vector<std::string> cells = {last.light, last.method, last.against};
    for (const double level : kLevels) {
      cells.push_back(fixed(milliseconds_to(report, last, level).value_or(NAN), 1));
    }
    EqualTimeRow tracing = last;
    tracing.method = kPathTracing;
    tracing.against = kTracedPicture;
    const auto traced = milliseconds_to(report, tracing, 40);
    const auto ours = milliseconds_to(report, last, 40);
    cells.push_back(ours && traced ? fixed(*traced / *ours, 1) : "-");
    cells.push_back(fixed(last.psnr_db, 1));
    table.rows.push_back(std::move(cells));
  }
  section.tables.push_back(std::move(table));
  return section;
}

Figures draw_figures(const EqualTimeReport& report, const std::filesystem::path& folder) {
  const std::vector<EqualTimeRow> runs = last_rows(report.rows);
  Figures figures;
  int number = 0;
  std::set<std::string> drawn;
  for (const EqualTimeRow& run : runs) {
    if (!drawn.insert(run.light).second) continue;
    const std::string picture = "equal-time-" + std::to_string(number++) + ".png";
    GnuplotScript script(picture);
    script.add("set title " +
               gnuplot_quote("After a quarter turn: " + report.scene + ", " + run.light));
    script.add("set xlabel \"milliseconds\"\nset logscale x\nset key outside right");
    script.add("set ylabel \"PSNR as displayed, dB\"");
    std::string plot;
    for (const EqualTimeRow& one : runs) {
      if (one.light != run.light) continue;
      std::vector<std::vector<double>> points;
      for (const EqualTimeRow& row : report.rows) {
        if (are_alike(row, one)) points.push_back({row.ms, row.psnr_db});
      }
      const std::string data = "d" + std::to_string(script.text().size());
      script.add_data(data, points);
      plot += (plot.empty() ? "plot $" : ", $") + data +
              " using 1:2 with linespoints lw 1.5 pt 7 ps 0.5 title " +
              gnuplot_quote(one.method + ", " + one.against);
    }
    script.add(plot);
    draw_figure(script, folder / picture, figures);
  }
  return figures;
}

}  // namespace rimlight
