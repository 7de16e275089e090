#include "cli/serve_check.h"

#include <unistd.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>

#include "cli/serve_fields.h"
#include "core/base/error.h"
#include "server/store/session_tables.h"

namespace rimlight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// "new", "whole", or "in use", of a store that a server has open now, which is then not looked
/// into; null where sessions live in memory.
json check_store(const fs::path& file) {
  if (file.empty()) return nullptr;
  std::error_code failure;
  if (!fs::exists(file, failure)) {
    const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
    if (::access(folder.c_str(), W_OK | X_OK) != 0) {
      throw Error(file.string(), "a folder that is missing or cannot be written",
                  "one where the store can be made");
    }
    return "new";
  }
  try {
    const server::SessionTables tables({.file = file});
    return "whole";
  } catch (const server::SqliteError& error) {
    if (error.is_in_use()) return "in use";
    throw;
  }
}

json check_scenes(const ServeConfig& config) {
  std::vector<server::ServedScene> scenes;
  json found = json::array();
  for (const fs::path& bake : config.bakes) {
    scenes.push_back(server::open_scene(bake, config.draw));
    const server::ServedScene& scene = scenes.back();
    found.push_back({{"name", scene.name},
                     {"width", scene.width},
                     {"height", scene.height},
                     {"environments", scene.environments}});
  }
  const server::SceneCatalog catalog(std::move(scenes));  // no name twice, and at least one
  return found;
}

json settings_of(const LayeredConfig& layers) {
  json settings = json::object();
  for (const ServeField& field : serve_fields()) {
    settings[field.name] = {{"value", field.show(layers.config)},
                            {"from", to_string(layers.sources.at(field.name))}};
  }
  return settings;
}

void print(const LayeredConfig& layers, const json& found) {
  for (const ServeField& field : serve_fields()) {
    std::string source = to_string(layers.sources.at(field.name));
    if (source == "environment") source += " " + field.variable();
    std::printf("%-30s %s (%s)\n", field.name.c_str(),
                found["settings"][field.name]["value"].dump().c_str(), source.c_str());
  }
  for (const json& scene : found["scenes"]) {
    std::printf("scene %s: %dx%d, %zu environments\n", scene["name"].get<std::string>().c_str(),
                scene["width"].get<int>(), scene["height"].get<int>(),
                scene["environments"].size());
  }
  std::printf("page: %d files\n", found["page_files"].get<int>());
  if (!found["store"].is_null()) {
    std::printf("store: %s\n", found["store"].get<std::string>().c_str());
  }
  for (const std::string& variable : layers.unknown_variables) {
    std::printf("%s: set, but no setting\n", variable.c_str());
  }
}

}  // namespace

int check_serve(const LayeredConfig& layers, bool as_json) {
  server::check_network(layers.config.network);
  const json found{{"settings", settings_of(layers)},
                   {"page_files", server::StaticFiles(layers.config.web).size()},
                   {"store", check_store(layers.config.store)},
                   {"scenes", check_scenes(layers.config)},
                   {"unknown_variables", layers.unknown_variables}};
  if (as_json) {
    std::printf("%s\n", found.dump().c_str());
  } else {
    print(layers, found);
  }
  return 0;
}

}  // namespace rimlight
