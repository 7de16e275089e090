#include <CLI/CLI.hpp>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/command.h"
#include "core/base/error.h"
#include "server/store/environment_folder.h"
#include "server/store/session_tables.h"

namespace rimlight {
namespace {

struct SessionsOptions {
  std::string store;
  std::string scene;
  std::string name;
  bool json = false;
};

/// Never makes one.
server::SessionTables open_tables(const std::string& store) {
  if (!std::filesystem::is_regular_file(store)) {
    throw Error(store, "no file", "the store of a server, as `serve --store` has it");
  }
  return server::SessionTables({.file = store});
}

/// "2026-11-22 16:05" in the machine's own time.
std::string time_text(std::int64_t milliseconds) {
  const auto seconds = static_cast<std::time_t>(milliseconds / 1000);
  std::tm time{};
  localtime_r(&seconds, &time);
  char text[32];
  return {text, std::strftime(text, sizeof text, "%Y-%m-%d %H:%M", &time)};
}

int list(const SessionsOptions& options) {
  server::SessionTables tables = open_tables(options.store);
  nlohmann::json sessions = nlohmann::json::array();
  for (const server::ListedSession& one : tables.list()) {
    sessions.push_back({{"scene", one.scene},
                        {"name", one.name},
                        {"revision", one.revision},
                        {"changed_ms", one.changed_ms},
                        {"snapshots", one.snapshots}});
    if (options.json) continue;
    std::printf("%s  %s  revision %lld, %lld snapshots, changed %s\n", one.scene.c_str(),
                one.name.c_str(), static_cast<long long>(one.revision),
                static_cast<long long>(one.snapshots), time_text(one.changed_ms).c_str());
  }
  if (options.json) std::printf("%s\n", nlohmann::json{{"sessions", sessions}}.dump().c_str());
  return 0;
}

int remove(const SessionsOptions& options) {
  server::SessionTables tables = open_tables(options.store);
  if (!tables.remove(options.scene, options.name)) {
    throw Error(options.store, "no session " + quote(options.name) + " of " + quote(options.scene),
                "one that `rimlight sessions list` names");
  }
  const std::string uploads = options.store + ".environments";
  if (std::filesystem::is_directory(uploads)) {
    server::EnvironmentFolder(uploads, 0).remove_all(options.scene, options.name);
  }
  return 0;
}

}  // namespace

void add_sessions_command(CLI::App& app, Action& chosen) {
  const auto options = std::make_shared<SessionsOptions>();
  CLI::App* const command = app.add_subcommand(
      "sessions", "List or delete the sessions of a store, while no server has it open");
  command->require_subcommand(1);
  CLI::App* const all = command->add_subcommand("list", "Print a line for each session");
  all->add_option("store", options->store, "The file of `serve --store`")->required();
  all->add_flag("--json", options->json, "Print {\"sessions\": […]}");
  all->callback([options, &chosen] { chosen = [options] { return list(*options); }; });
  CLI::App* const one = command->add_subcommand(
      "delete", "Delete a session for good, with its history, snapshots and uploads");
  one->add_option("store", options->store, "The file of `serve --store`")->required();
  one->add_option("scene", options->scene, "The session's scene")->required();
  one->add_option("name", options->name, "Its name")->required();
  one->callback([options, &chosen] { chosen = [options] { return remove(*options); }; });
}

}  // namespace rimlight
