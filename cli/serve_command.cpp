#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <utility>

#include "cli/command.h"
#include "cli/serve_check.h"
#include "cli/serve_config.h"
#include "cli/serve_layers.h"
#include "core/base/error.h"
#include "core/relight/policy_settings.h"
#include "server/log/event_log.h"
#include "server/schedule/render_queue.h"
#include "server/session/baked_scene.h"
#include "server/store/sqlite_store.h"

namespace rimlight {
namespace {

/// What the disk may take for the edits that wait when the server stops.
constexpr std::chrono::milliseconds kLastCommits{800};

struct ServeOptions {
  std::vector<std::string> bakes;
  std::string config;
  std::string web;
  std::string host;
  std::optional<std::uint16_t> port;
  std::string key;
  server::TlsFiles tls;
  bool selftest_echo = false;
  std::vector<std::string> host_names;
  std::vector<std::string> origins;
  std::string budget;
  std::string policy;
  std::string window;
  std::string store;
  std::string log;
  bool check = false;
  bool json = false;
};

/// What is wrong with the text of an option; empty when nothing is.
template <typename Parse>
std::string fault_of(const Parse& parse) {
  try {
    parse();
    return {};
  } catch (const Error& error) {
    return "found " + error.found() + ", expected " + error.expected();
  }
}
std::string policy_fault(const std::string& text) {
  return fault_of([&text] { parse_policy(text, "--policy"); });
}
std::string budget_fault(const std::string& text) {
  return fault_of([&text] { parse_budget(text, "--budget"); });
}

std::string window_fault(const std::string& text) {
  return fault_of([&text] { parse_window(text, "--window"); });
}

/// By the names of their fields.
OptionValues values_of(const ServeOptions& options) {
  OptionValues values;
  const auto text = [&values](const char* field, const std::string& value) {
    if (!value.empty()) values[field] = value;
  };
  const auto list = [&values](const char* field, const std::vector<std::string>& value) {
    if (!value.empty()) values[field] = value;
  };
  list("bakes", options.bakes);
  text("web", options.web);
  text("host", options.host);
  if (options.port) values["port"] = *options.port;
  text("key_file", options.key);
  text("tls_certificate", options.tls.certificate);
  text("tls_key", options.tls.key);
  if (options.selftest_echo) values["selftest_echo"] = true;
  list("host_names", options.host_names);
  list("origins", options.origins);
  text("budget", options.budget);
  text("policy", options.policy);
  text("window", options.window);
  text("store", options.store);
  text("log", options.log);
  return values;
}

/// Options over environment over file, and what files they name that must be read at once.
LayeredConfig merge(const ServeOptions& options) {
  LayeredConfig layers = layer_config(options.config, rimlight_variables(), values_of(options));
  ServeConfig& config = layers.config;
  if (!config.key_file.empty()) {
    config.network.keys =
        std::make_shared<const server::SigningKeys>(server::read_signing_keys(config.key_file));
  }
  if (config.web.empty()) config.web = find_web_folder();
  return layers;
}

server::SceneCatalog open_scenes(const ServeConfig& config) {
  std::vector<server::ServedScene> scenes;
  for (const std::filesystem::path& folder : config.bakes) {
    scenes.push_back(server::open_scene(folder, config.draw));
    spdlog::info("opened {}: {}x{}, {} environments", folder.string(), scenes.back().width,
                 scenes.back().height, scenes.back().environments.size());
  }
  return server::SceneCatalog(std::move(scenes));
}

/// Nothing where sessions live in memory.
std::unique_ptr<server::SessionStore> open_store(const ServeConfig& config) {
  if (config.store.empty()) {
    spdlog::info("sessions live in memory: --store keeps them in a file");
    return nullptr;
  }
  auto store = std::make_unique<server::SqliteStore>(
      server::SqliteStoreSettings{.file = config.store, .metrics = config.network.metrics});
  spdlog::info("sessions are kept in {}", config.store.string());
  return store;
}

/// For what counts as much: one count of everything.
std::shared_ptr<server::ServerMetrics> count_all(ServeConfig& config) {
  auto metrics = std::make_shared<server::ServerMetrics>();
  config.network.metrics = metrics;
  config.sessions.session.metrics = metrics;
  server::ServerMetrics::Limits limits{.scenes = config.bakes.size(),
                                       .most_sockets = config.network.most_connections,
                                       .most_sessions = config.sessions.most_sessions};
  const FrameBudget& budget = config.draw.relight.budget;
  switch (budget.unit) {
    case FrameBudget::Unit::coefficients:
      limits.budget_columns = budget.amount;
      break;
    case FrameBudget::Unit::bytes:
      limits.budget_bytes = budget.amount;
      break;
    case FrameBudget::Unit::milliseconds:
      limits.budget_seconds = budget.amount / 1000;
      break;
  }
  metrics->serve(limits);
  return metrics;
}

/// Beside the store: FILE.environments. Nothing where sessions live in memory.
std::unique_ptr<server::EnvironmentFolder> open_uploads(const ServeConfig& config) {
  constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;
  if (config.store.empty()) return nullptr;
  auto uploads = std::make_unique<server::EnvironmentFolder>(
      config.store.string() + ".environments", kMostBytes);
  if (const std::size_t count = uploads->collect(); count > 0) {
    spdlog::info("{} uploaded environments that no session has are deleted", count);
  }
  return uploads;
}

int serve(const ServeOptions& options) {
  LayeredConfig layers = merge(options);
  ServeConfig& config = layers.config;
  if (config.log == LogFormat::json) server::log_as_json();
  if (options.check) return check_serve(layers, options.json);
  const std::shared_ptr<server::ServerMetrics> metrics = count_all(config);
  const server::StaticFiles files(config.web);
  const server::SceneCatalog scenes = open_scenes(config);
  server::RenderQueue queue;
  // Ends after the sessions, and before what their last edits still schedule.
  const std::unique_ptr<server::SessionStore> store = open_store(config);
  const std::unique_ptr<server::EnvironmentFolder> uploads = open_uploads(config);
  server::SessionRegistry sessions(scenes, queue, config.sessions, store.get(), uploads.get());
  server::HttpServer http(config.network, files, sessions);
  std::jthread compute([&queue](const std::stop_token& stop) { queue.run(stop); });

  spdlog::info("serving {}/", http.address());
  if (options.json) {
    std::printf("%s\n", nlohmann::json{{"address", http.address() + "/"}}.dump().c_str());
    std::fflush(stdout);
  }
  http.run(server::HttpServer::Signals::watch);
  sessions.close_all();
  if (store && !store->drain(kLastCommits)) {
    spdlog::warn("the store did not take all edits; none of these was acknowledged");
  }
  spdlog::info("stopped");
  return 0;
}

}  // namespace

void add_serve_command(CLI::App& app, Action& chosen) {
  const auto options = std::make_shared<ServeOptions>();
  CLI::App* const command =
      app.add_subcommand("serve", "Serve bakes to browsers: the page, sessions, relit frames");
  command->add_option("bakes", options->bakes, "The bakes to serve; the first is the default");
  command->add_option("--config", options->config,
                      "A JSON file of settings; the environment (RIMLIGHT_PORT, …) and options "
                      "overrule it");
  command->add_option("--host", options->host,
                      "The address to listen on; beyond loopback --key is needed [127.0.0.1]");
  command->add_option("--port", options->port, "The port; 0 takes a free one [8080]");
  command->add_option("--key", options->key,
                      "A file of signing keys: clients must show tokens (`rimlight token`)");
  command->add_option("--tls-certificate", options->tls.certificate,
                      "A chain of certificates in PEM: https and wss; SIGHUP reads it again");
  command->add_option("--tls-key", options->tls.key, "Its private key in PEM, for this user alone");
  command->add_flag("--selftest-echo", options->selftest_echo,
                    "/selftest/echo sends messages back, for conformance suites; on loopback only");
  command->add_option("--host-name", options->host_names,
                      "A name that clients call this server by, besides addresses and localhost");
  command->add_option("--origin", options->origins,
                      "An origin whose pages may connect, besides the server's own");
  command->add_option("--web", options->web, "The page's folder [found near the program]");
  command
      ->add_option("--budget", options->budget,
                   "What a frame in motion may cost: 30 (columns of the transport), 2MB (of it) or "
                   "8ms (from the edit to its pixels) [8ms]")
      ->check(budget_fault, "BUDGET");
  command
      ->add_option("--policy", options->policy,
                   "How frames in motion are approximated: linear, nwa, bi, pbi or benefit; then, "
                   "after colons, a band test of pbi (simple, dealer, exhaustive) and a selection "
                   "of nwa, bi and pbi (unweighted, area, transport) [benefit]")
      ->check(policy_fault, "POLICY");
  command
      ->add_option("--window", options->window,
                   "Against dark rings about the highlights of bakes of kind vertex_sh: none, "
                   "hann, lanczos or fitted [fitted]")
      ->check(window_fault, "WINDOW");
  command
      ->add_option("--store", options->store,
                   "A file that keeps the sessions over restarts; made where it is not there "
                   "[none: they live in memory]")
      ->take_last();
  command->add_option("--log", options->log, "How the log is written: text or json [text]")
      ->check(CLI::IsMember({"text", "json"}));
  command->add_flag("--check-config", options->check,
                    "Read and open all that would be used, say what and where each value comes "
                    "from, and end without listening");
  command->add_flag("--json", options->json,
                    "Print {\"address\": …} when ready; with --check-config, what is checked");
  command->callback([options, &chosen] { chosen = [options] { return serve(*options); }; });
}

}  // namespace rimlight
