#include "server/session/scene_catalog.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "core/base/error.h"
#include "server/protocol/query_string.h"

namespace rimlight::server {

namespace {

/// The one of that name. Throws Error.
template <typename Named>
const Named& find_named(const std::vector<Named>& all, const char* what, const std::string& name) {
  const auto found = std::ranges::find(all, name, &Named::name);
  if (found != all.end()) return *found;
  std::string names;
  for (const Named& one : all) names += " " + quote(one.name);
  throw Error("URL", std::string("the ") + what + " " + quote(name),
              all.empty() ? std::string("a scene that has one") : "one of" + names);
}

}  // namespace

KnownMaterials known_materials(const ServedScene& scene) {
  KnownMaterials known;
  for (const VertexMaterial& material : scene.materials) known.names.push_back(material.name);
  for (const CurveMaterial& material : scene.editable) {
    known.names.push_back(material.name);
    known.editable[material.name] =
        scene.measured.empty() ? curve_axes(material)
                               : std::vector{CurveAxis::half_angle, CurveAxis::difference_angle};
  }
  for (const MeasuredChoice& choice : scene.measured) known.measured.push_back(choice.name);
  return known;
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

std::string SceneCatalog::curves(std::string_view query) const {
  const auto parameters = parse_query(query, {"scene", "material", "measured"});
  const auto of = [&](const char* name) {
    const auto found = parameters.find(name);
    return found == parameters.end() ? std::string() : found->second;
  };
  const ServedScene* const scene = find(of("scene"));
  if (scene == nullptr) throw Error("URL", "the scene " + quote(of("scene")), "one of /api/scenes");
  const CurveMaterial& material = find_named(scene->editable, "editable material", of("material"));
  const nlohmann::json body =
      parameters.contains("measured")
          ? curves_to_json(find_named(scene->measured, "measured BRDF", of("measured")).brdf)
          : curves_to_json(material);
  return body.dump();
}

}  // namespace rimlight::server
