#include "server/session/scene_catalog.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "core/base/error.h"

namespace rimlight::server {

std::vector<std::string> material_names(const ServedScene& scene) {
  std::vector<std::string> names;
  for (const VertexMaterial& material : scene.materials) names.push_back(material.name);
  return names;
}

SceneCatalog::SceneCatalog(std::vector<ServedScene> scenes) : scenes_(std::move(scenes)) {
  if (scenes_.empty()) throw Error("serve", "no bakes", "one or more");
  std::set<std::string> names;
  for (const ServedScene& scene : scenes_) {
    if (!names.insert(scene.name).second) {
      throw Error("serve", "two bakes named " + quote(scene.name), "different names");
    }
  }
}

const ServedScene* SceneCatalog::find(std::string_view name) const {
  if (name.empty()) return &scenes_.front();
  const auto found = std::find_if(scenes_.begin(), scenes_.end(),
                                  [&](const ServedScene& scene) { return scene.name == name; });
  return found == scenes_.end() ? nullptr : &*found;
}

std::string SceneCatalog::to_json() const {
  nlohmann::json list = nlohmann::json::array();
  for (const ServedScene& scene : scenes_) {
    list.push_back({{"name", scene.name},
                    {"default", &scene == &scenes_.front()},
                    {"size", {{"width", scene.width}, {"height", scene.height}}},
                    {"environments", scene.environments}});
  }
  return nlohmann::json{{"scenes", list}}.dump(-1, ' ', false,
                                               nlohmann::json::error_handler_t::replace);
}

}  // namespace rimlight::server
