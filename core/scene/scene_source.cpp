#include "core/scene/scene_source.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/files.h"
#include "core/base/json_reader.h"
#include "core/scene/material_source.h"
#include "core/scene/measured_source.h"
#include "core/scene/object_source.h"
#include "core/scene/terrace.h"

namespace rimlight {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestSource = std::size_t{16} << 20;
constexpr std::size_t kMostObjects = 10'000;
constexpr std::size_t kMostMaterials = 10'000;
constexpr std::size_t kMostEnvironments = 64;
constexpr std::size_t kMostEditable = 256;
constexpr int kLeastCurveCubeSize = 8;  // what surfaces see of the sky is kept in blocks of 8 × 8

Camera read_camera(const JsonReader& json) {
  json.allow_only({"position", "target", "up", "field_of_view"});
  Camera camera;
  camera.position = read_point(json.member("position"));
  camera.target = read_point(json.member("target"));
  if (const auto up = json.optional_member("up")) camera.up = read_point(*up);
  if (const auto angle = json.optional_member("field_of_view")) {
    camera.vertical_field_of_view_degrees = angle->number(kLeastFieldOfView, kMostFieldOfView);
  }
  check_camera(camera, json.where());
  return camera;
}

EnvironmentLayout read_layout(const JsonReader& json) {
  constexpr EnvironmentLayout kLayouts[] = {
      EnvironmentLayout::automatic, EnvironmentLayout::lat_long, EnvironmentLayout::angular_map,
      EnvironmentLayout::cube};
  return kLayouts[json.one_of({"automatic", "lat_long", "angular_map", "cube"})];
}

Environment read_environment(const JsonReader& json, const fs::path& folder) {
  if (json.is_string()) {
    const auto& names = builtin_environment_names();
    return builtin_environment(names[json.one_of(names)]);
  }
  json.allow_only({"file", "layout", "name"});
  const JsonReader file = json.member("file");
  const auto layout = json.optional_member("layout");
  const auto name = json.optional_member("name");
  const EnvironmentLayout chosen = layout ? read_layout(*layout) : EnvironmentLayout::automatic;
  const std::string new_name = name ? read_name(*name) : "";
  try {
    Environment environment = load_environment(folder / file.string(), chosen);
    if (!name) return environment;
    return Environment(new_name, environment.image(), environment.layout());
  } catch (const Error& error) {
    throw Error(file.where() + ": " + error.where(), error.found(), error.expected());
  }
}

std::vector<Environment> read_environments(const JsonReader& json, const fs::path& folder) {
  std::vector<Environment> environments;
  for (const JsonReader& element : json.elements(1, kMostEnvironments)) {
    Environment environment = read_environment(element, folder);
    for (const Environment& other : environments) {
      if (other.name() != environment.name()) continue;
      throw Error(element.where(), "the name " + quote(environment.name()) + " twice",
                  "a name of its own for each environment");
    }
    environments.push_back(std::move(environment));
  }
  return environments;
}

/// Above 2^53 JSON numbers are not exact everywhere.
std::uint64_t read_seed(const JsonReader& json) {
  return static_cast<std::uint64_t>(json.integer(0, std::int64_t{1} << 53));
}

/// Sets `value` from an optional field.
void read_integer(const JsonReader& json, std::string_view name, int low, int high, int& value) {
  const auto field = json.optional_member(name);
  if (field) value = static_cast<int>(field->integer(low, high));
}

void read_image_bake(const JsonReader& json, BakeSettings& bake) {
  json.allow_only({"kind", "width", "height", "cube_size", "primary_rays", "bounces", "psnr_db",
                   "seed", "editable"});
  const bool of_curves = bake.kind == BakeKind::brdf_curve;
  const int least_size = of_curves ? kLeastCurveCubeSize : 4;
  read_integer(json, "cube_size", least_size, 128, bake.cube_size);
  if (const auto editable = json.optional_member("editable")) {
    if (!of_curves) editable->fail("nothing for this kind of bake: \"brdf_curve\" has it");
    for (const JsonReader& name : editable->elements(1, kMostEditable)) {
      bake.editable.push_back(name.string());
    }
  }
  read_integer(json, "primary_rays", 1, 256, bake.primary_rays);
  read_integer(json, "bounces", 0, 64, bake.bounces);
  if ((bake.cube_size & (bake.cube_size - 1)) != 0) {
    json.member("cube_size").fail("4, 8, 16, 32, 64 or 128");
  }
  if (const auto psnr = json.optional_member("psnr_db")) bake.psnr_db = psnr->number(20, 90);
}

void read_vertex_bake(const JsonReader& json, VertexBakeSettings& vertex) {
  json.allow_only({"kind", "width", "height", "degree", "error", "transfer", "most_rays",
                   "keep_bands", "longest_edge", "sun", "seed"});
  constexpr VertexTransfer kTransfers[] = {VertexTransfer::unshadowed, VertexTransfer::shadowed,
                                           VertexTransfer::interreflected};
  read_integer(json, "degree", 0, VertexBakeSettings::kLargestDegree, vertex.degree);
  read_integer(json, "most_rays", 64, 1 << 20, vertex.most_rays);
  if (const auto error = json.optional_member("error")) vertex.error = error->number(1e-4, 1);
  if (const auto transfer = json.optional_member("transfer")) {
    vertex.transfer = kTransfers[transfer->one_of({"unshadowed", "shadowed", "interreflected"})];
  }
  if (const auto keep = json.optional_member("keep_bands")) vertex.keep_bands = keep->boolean();
  if (const auto edge = json.optional_member("longest_edge")) {
    vertex.longest_edge = edge->number(0, 1);
  }
  if (const auto sun = json.optional_member("sun")) {
    constexpr SunLight kLights[] = {SunLight::directional, SunLight::harmonics};
    vertex.sun = kLights[sun->one_of({"directional", "harmonics"})];
  }
}

BakeSettings read_bake(const JsonReader& json) {
  BakeSettings bake;
  const auto kind = json.optional_member("kind");
  if (kind) {
    constexpr BakeKind kKinds[] = {BakeKind::image_haar, BakeKind::vertex_sh, BakeKind::brdf_curve};
    bake.kind = kKinds[kind->one_of({"image_haar", "vertex_sh", "brdf_curve"})];
  }
  if (bake.kind == BakeKind::vertex_sh) {
    read_vertex_bake(json, bake.vertex);
  } else {
    read_image_bake(json, bake);
  }
  read_integer(json, "width", 1, 8192, bake.width);
  read_integer(json, "height", 1, 8192, bake.height);
  if (const auto seed = json.optional_member("seed")) bake.seed = read_seed(*seed);
  return bake;
}

/// Adds a builtin's meshes and materials; its camera stands in where the source gives none.
void add_builtin(const JsonReader& json, Scene& scene, std::optional<Camera>& camera) {
  json.allow_only({"builtin", "seed"});
  json.member("builtin").one_of({"terrace"});
  const auto seed = json.optional_member("seed");
  Scene made = terrace::make_scene(seed ? read_seed(*seed) : 1);
  const auto first_material = static_cast<std::uint32_t>(scene.materials.size());
  for (Mesh& mesh : made.meshes) mesh.material += first_material;
  std::move(made.meshes.begin(), made.meshes.end(), std::back_inserter(scene.meshes));
  std::move(made.materials.begin(), made.materials.end(), std::back_inserter(scene.materials));
  if (!camera) camera = made.camera;
}

void read_objects(const JsonReader& json, const ObjectContext& context, Scene& scene,
                  std::optional<Camera>& camera) {
  for (const JsonReader& object : json.elements(1, kMostObjects)) {
    const int kinds =
        int{object.has("file")} + int{object.has("shape")} + int{object.has("builtin")};
    if (kinds != 1) object.fail("one of \"file\", \"shape\" and \"builtin\"");
    if (object.has("builtin")) {
      add_builtin(object, scene, camera);
    } else {
      add_object(object, context, scene);
    }
  }
}

ObjectContext read_materials(const JsonReader& json, const fs::path& folder, Scene& scene) {
  ObjectContext context{folder, {}};
  const auto members = json.members();
  if (members.size() > kMostMaterials) {
    throw Error(json.where(), std::to_string(members.size()) + " materials",
                "at most " + std::to_string(kMostMaterials));
  }
  for (const auto& [name, material] : members) {
    context.material_named[name] = static_cast<std::uint32_t>(scene.materials.size());
    scene.materials.push_back(read_material(material, name, folder, scene.measured));
  }
  return context;
}

Scene read_document(const JsonReader& json, const fs::path& folder) {
  json.allow_only(
      {"$schema", "name", "camera", "measured", "materials", "objects", "environments", "bake"});
  Scene scene;
  const auto name = json.optional_member("name");
  scene.name = name ? read_name(*name) : fs::path(json.source()).stem().string();
  // Cheap parts first: a mistake in them should not wait for the meshes.
  if (const auto bake = json.optional_member("bake")) scene.bake = read_bake(*bake);
  std::optional<Camera> camera;
  if (const auto field = json.optional_member("camera")) camera = read_camera(*field);
  if (const auto measured = json.optional_member("measured")) {
    scene.measured = read_measured_list(*measured, folder);
  }
  ObjectContext context{folder, {}};
  if (const auto materials = json.optional_member("materials")) {
    context = read_materials(*materials, folder, scene);
  }
  read_objects(json.member("objects"), context, scene, camera);
  scene.camera = camera ? *camera : read_camera(json.member("camera"));  // throws: it is missing
  if (const auto environments = json.optional_member("environments")) {
    scene.environments = read_environments(*environments, folder);
  } else {
    for (const std::string& builtin : builtin_environment_names()) {
      scene.environments.push_back(builtin_environment(builtin));
    }
  }
  return scene;
}

}  // namespace

Scene parse_scene(std::string_view text, const std::string& source, const fs::path& folder) {
  const nlohmann::json document = parse_json(text, source);
  return read_document(JsonReader(document, source), folder);
}

Scene read_scene(const fs::path& path) {
  return parse_scene(read_file(path, kLargestSource), path.string(), path.parent_path());
}

}  // namespace rimlight
