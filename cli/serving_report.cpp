#include "cli/serving_report.h"

#include <algorithm>
#include <thread>

#include "cli/load_run.h"
#include "cli/serve_config.h"
#include "core/image/vp8_codec.h"
#include "core/report/report_files.h"
#include "server/network/static_files.h"
#include "server/session/baked_scene.h"
#include "server/session/session_registry.h"

namespace rimlight {
namespace {

using nlohmann::json;

/// A server in this process, on a port of its own, until it goes out of scope.
class OwnServer {
 public:
  OwnServer(const std::filesystem::path& bake, ServeConfig config)
      : scenes_({server::open_scene(bake, config.draw)}),
        files_(find_web_folder()),
        sessions_(scenes_, queue_, config.sessions, nullptr, nullptr),
        settings_(std::move(config.network)),
        http_(settings_, files_, sessions_),
        compute_([this](const std::stop_token& stop) { queue_.run(stop); }),
        network_([this] { http_.run(server::HttpServer::Signals::leave_alone); }) {}
  ~OwnServer() {
    http_.stop();
    network_.join();
    sessions_.close_all();
  }
  OwnServer(const OwnServer&) = delete;
  OwnServer& operator=(const OwnServer&) = delete;

  StreamUrl url() const {
    const std::string address = http_.address();
    return {"127.0.0.1", address.substr(address.rfind(':') + 1)};
  }

 private:
  server::SceneCatalog scenes_;
  server::StaticFiles files_;
  server::RenderQueue queue_;
  server::SessionRegistry sessions_;
  const server::NetworkSettings settings_;
  server::HttpServer http_;
  std::jthread compute_, network_;
};

std::string who(const ServingRow& row) {
  const std::string count = std::to_string(row.clients);
  if (row.clients == 1) return "1 client, " + row.codec;
  return count + (row.shared_session ? " clients of one session, " : " clients, a session each, ") +
         row.codec;
}

std::vector<ServingRow> crowds() {
  std::vector<ServingRow> rows = {{1, false, "jpeg", {}}};
  if (has_vp8()) rows.push_back({1, false, "vp8", {}});
  rows.push_back({16, true, "jpeg", {}});
  rows.push_back({4, false, "jpeg", {}});
  return rows;
}

/// Of the checks that were run and did not hold.
std::string faults_of(const LoadReport& load) {
  std::string faults;
  for (const LoadCheck& check : load.checks) {
    if (check.pass.value_or(true)) continue;
    faults += (faults.empty() ? "" : "; ") + check.name + ": " + check.detail;
  }
  return faults;
}

}  // namespace

ServingReport measure_serving(const std::filesystem::path& bake, double seconds,
                              const std::function<void(const std::string&, double)>& progress) {
  ServeConfig config;
  config.network.port = 0;
  const OwnServer served(bake, std::move(config));
  ServingReport report{.bake = bake.stem().string(), .seconds = seconds, .rows = crowds()};
  double done = 0;
  for (ServingRow& row : report.rows) {
    progress(who(row), done++ / static_cast<double>(report.rows.size()));
    const auto records = play_run({.url = served.url(),
                                   .script = default_script(seconds),
                                   .seconds = seconds,
                                   .clients = row.clients,
                                   .shared_session = row.shared_session,
                                   .codec = row.codec == "vp8" ? LoadCodec::vp8 : LoadCodec::jpeg});
    row.load = summarize(records, ScriptKind::every_edit_changes);
    row.load.checks.push_back(compare_with_bake(records, bake.string(), {}));
  }
  return report;
}

json to_json(const ServingReport& report) {
  json rows = json::array();
  for (const ServingRow& row : report.rows) {
    const LoadReport& load = row.load;
    json one = {{"bake", report.bake},
                {"clients", row.clients},
                {"shared_session", row.shared_session},
                {"codec", row.codec},
                {"frames_per_second", load.frames_per_second},
                {"latency_p50_ms", load.latency_p50_ms},
                {"latency_p95_ms", load.latency_p95_ms},
                {"latency_p99_ms", load.latency_p99_ms},
                {"bytes_per_frame", load.bytes_per_frame},
                {"exact_after_ms", load.exact_after_ms},
                {"pass", load.passed()},
                {"faults", faults_of(load)}};
    rows.push_back(std::move(one));
  }
  return {{"experiment", "serving"},
          {"machine", describe_machine()},
          {"seconds", report.seconds},
          {"rows", std::move(rows)}};
}

ReportSection section_of(const ServingReport& report) {
  ReportSection section{.title = "Serving: " + report.bake,
                        .question =
                            "What clients get whose light turns with every edit, 60 edits "
                            "a second a session, server and clients on the same cores."};
  section.remarks.push_back(fixed(report.seconds, 1) + " seconds each.");
  Table table{.columns = {"clients", "frames/s in all", "edit to frame p50, ms", "p95", "p99",
                          "KB a frame", "last exact after, ms"}};
  for (const ServingRow& row : report.rows) {
    const LoadReport& load = row.load;
    table.rows.push_back({who(row), fixed(load.frames_per_second, 1), fixed(load.latency_p50_ms, 1),
                          fixed(load.latency_p95_ms, 1), fixed(load.latency_p99_ms, 1),
                          fixed(load.bytes_per_frame / 1000, 1), fixed(load.exact_after_ms, 0)});
    const std::string faults = faults_of(load);
    if (!faults.empty()) section.remarks.push_back("Checks failed: " + who(row) + ": " + faults);
  }
  section.tables.push_back(std::move(table));
  return section;
}

Figures draw_figures(const ServingReport& report, const std::filesystem::path& folder) {
  GnuplotScript script("serving.png");
  script.add("set title " + gnuplot_quote("Edit to frame: " + report.bake));
  script.add("set style data histograms\nset style fill solid 0.8\nset key top left");
  script.add("set ylabel \"milliseconds\"\nset yrange [0:]");
  std::vector<std::vector<double>> points;
  std::string names;
  for (const ServingRow& row : report.rows) {
    points.push_back({row.load.latency_p50_ms, row.load.latency_p95_ms, row.load.latency_p99_ms});
    names += (names.empty() ? "" : ", ") + gnuplot_quote(who(row)) + " " +
             std::to_string(points.size() - 1);
  }
  script.add("set xtics (" + names + ")");
  script.add_data("d", points);
  script.add("plot $d using 1 title \"p50\", $d using 2 title \"p95\", $d using 3 title \"p99\"");
  Figures figures;
  draw_figure(script, folder / "serving.png", figures);
  return figures;
}

}  // namespace rimlight
