#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/load_report.h"
#include "core/report/gnuplot.h"
#include "core/report/report_page.h"

namespace rimlight {

/// One crowd of scripted clients on one server.
struct ServingRow {
  int clients = 1;
  bool shared_session = false;  // else a session each
  std::string codec;            // "jpeg", "vp8"
  LoadReport load;
};

struct ServingReport {
  std::string bake;
  double seconds = 0;  // of each row
  std::vector<ServingRow> rows;
};

/// Serves a bake on a free port of this machine, with the settings that `rimlight serve` has, and
/// lets crowds of clients play the default script of `rimlight load` against it: all of it on the
/// same cores. Throws Error when the page is not found or nothing can listen.
ServingReport measure_serving(const std::filesystem::path& bake, double seconds,
                              const std::function<void(const std::string&, double)>& progress);

/// docs/formats/report.md.
nlohmann::json to_json(const ServingReport& report);
ReportSection section_of(const ServingReport& report);
/// Latencies of each crowd. As draw_figures() of core/report/figures.h.
Figures draw_figures(const ServingReport& report, const std::filesystem::path& folder);

}  // namespace rimlight
