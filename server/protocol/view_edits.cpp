#include "server/protocol/view_edits.h"

#include <algorithm>

#include "core/base/error.h"

namespace rimlight::server {
namespace {

using nlohmann::json;

constexpr double kFarthest = 1e9;  // as check_camera() has it

Vec3d read_point(const JsonReader& reader) {
  const std::vector<double> v = reader.numbers(3, -kFarthest, kFarthest);
  return {v[0], v[1], v[2]};
}

Vec3f read_colour(const JsonReader& reader) {
  const std::vector<double> v = reader.numbers(3, 0, 1);
  return Vec3f(Vec3d(v[0], v[1], v[2]));
}

template <typename T>
json to_json(const Vec3<T>& v) {
  return {v.x, v.y, v.z};
}

/// Null is a lobe of no values.
std::vector<double> read_lobe(const JsonReader& reader) {
  std::vector<double> lobe;
  if (reader.value().is_null()) return lobe;
  for (const JsonReader& value : reader.elements(kFewestLobeValues, kMostLobeValues)) {
    lobe.push_back(value.number(0, kLargestLobeValue));
  }
  check_lobe(lobe, reader.where());
  return lobe;
}

MaterialEdit read_parameters(const JsonReader& reader) {
  reader.allow_only({"albedo", "highlight", "exponent", "lobe"});
  MaterialEdit edit;
  if (const auto member = reader.optional_member("albedo")) edit.albedo = read_colour(*member);
  if (const auto member = reader.optional_member("highlight")) {
    edit.highlight = read_colour(*member);
  }
  if (const auto member = reader.optional_member("exponent")) {
    edit.exponent = member->number(0, kLargestExponent);
  }
  if (const auto member = reader.optional_member("lobe")) edit.lobe = read_lobe(*member);
  if (edit == MaterialEdit()) {
    reader.fail("one or more of albedo, highlight, exponent, lobe; or null");
  }
  return edit;
}

void check_name(const JsonReader& reader, const std::string& name,
                const std::vector<std::string>& materials) {
  if (name.empty() || name.size() > kLongestMaterial) {
    throw Error(reader.where(), "a name of " + std::to_string(name.size()) + " bytes",
                "1 to " + std::to_string(kLongestMaterial));
  }
  if (materials.empty() || std::ranges::find(materials, name) != materials.end()) return;
  std::string names;
  for (const std::string& known : materials) names += " " + quote(known);
  throw Error(reader.where(), "a material " + quote(name), "one of" + names);
}

void set_given(const MaterialEdit& edit, MaterialEdit& material) {
  if (edit.albedo) material.albedo = edit.albedo;
  if (edit.highlight) material.highlight = edit.highlight;
  if (edit.exponent) {
    material.exponent = edit.exponent;
    material.lobe.reset();
  }
  if (edit.lobe) material.lobe = edit.lobe;
  if (material.lobe && material.lobe->empty()) material.lobe.reset();
}

}  // namespace

std::optional<Camera> read_view(const JsonReader& reader) {
  reader.allow_only({"camera"});
  const JsonReader camera = reader.member("camera");
  if (camera.value().is_null()) return std::nullopt;
  camera.allow_only({"position", "target", "up", "fov"});
  Camera view;
  view.position = read_point(camera.member("position"));
  view.target = read_point(camera.member("target"));
  view.up = read_point(camera.member("up"));
  view.vertical_field_of_view_degrees =
      camera.member("fov").number(kLeastFieldOfView, kMostFieldOfView);
  check_camera(view, camera.where());
  return view;
}

MaterialEdits read_material(const JsonReader& reader, const std::vector<std::string>& materials) {
  reader.allow_only({"parameter"});
  const JsonReader parameter = reader.member("parameter");
  MaterialEdits edits;
  for (const auto& [name, value] : parameter.members()) {
    check_name(parameter, name, materials);
    if (value.value().is_null()) {
      edits.emplace(name, std::nullopt);
    } else {
      edits.emplace(name, read_parameters(value));
    }
  }
  if (edits.empty() || edits.size() > kMostMaterials) {
    parameter.fail("1 to " + std::to_string(kMostMaterials) + " materials");
  }
  return edits;
}

json camera_to_json(const Camera& camera) {
  return {{"position", to_json(camera.position)},
          {"target", to_json(camera.target)},
          {"up", to_json(camera.up)},
          {"fov", camera.vertical_field_of_view_degrees}};
}

json view_to_json(const std::optional<Camera>& view) {
  return {{"camera", view ? camera_to_json(*view) : json()}};
}

json parameters_to_json(const MaterialEdit& edit) {
  json text = json::object();
  if (edit.albedo) text["albedo"] = to_json(*edit.albedo);
  if (edit.highlight) text["highlight"] = to_json(*edit.highlight);
  if (edit.exponent) text["exponent"] = *edit.exponent;
  if (edit.lobe) text["lobe"] = *edit.lobe;
  return text;
}

json material_to_json(const std::map<std::string, MaterialEdit>& materials) {
  json parameter = json::object();
  for (const auto& [name, edit] : materials) parameter[name] = parameters_to_json(edit);
  return {{"parameter", parameter}};
}

void apply_material(const MaterialEdits& edits, std::map<std::string, MaterialEdit>& materials) {
  std::map<std::string, MaterialEdit> changed = materials;
  for (const auto& [name, edit] : edits) {
    if (edit) set_given(*edit, changed[name]);
    if (!edit || changed[name] == MaterialEdit()) changed.erase(name);
  }
  if (changed.size() > kMostMaterials) {
    throw Error("message: /material/parameter",
                "edits of " + std::to_string(changed.size()) + " materials in the session",
                "at most " + std::to_string(kMostMaterials));
  }
  materials = std::move(changed);
}

}  // namespace rimlight::server
