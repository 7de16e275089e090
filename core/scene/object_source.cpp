#include "core/scene/object_source.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/scene/material_source.h"
#include "core/scene/mesh_file.h"
#include "core/scene/mesh_geometry.h"
#include "core/scene/shapes.h"
#include "core/scene/transform.h"

namespace rimlight {
namespace {

/// Sizes and scales: what a float scene can hold beside other things.
constexpr double kSmallest = 1e-6;
constexpr double kLargest = 1e6;
/// After every transform; beyond this the squares of distances leave the range of floats.
constexpr float kFarthest = 1e9f;

double size_of(const JsonReader& json, std::string_view name, double otherwise) {
  const auto field = json.optional_member(name);
  return field ? field->number(kSmallest, kLargest) : otherwise;
}

int segments_of(const JsonReader& json) {
  const auto field = json.optional_member("segments");
  return field ? static_cast<int>(field->integer(3, 1024)) : 64;
}

Vec3d read_sizes(const JsonReader& json, std::size_t count) {
  const std::vector<double> sizes = json.numbers(count, kSmallest, kLargest);
  return {sizes[0], sizes[1], count > 2 ? sizes[2] : 0};
}

/// Refuses fields beside an object's own and those that every object may have.
void allow_fields(const JsonReader& json, std::vector<std::string_view> own) {
  own.insert(own.end(), {"material", "scale", "rotate", "fit", "translate"});
  json.allow_only(own);
}

Mesh read_shape(const JsonReader& json) {
  const std::vector<std::string> names{"sphere", "box",  "torus",   "plane",
                                       "disc",   "cone", "cylinder"};
  const std::string shape = names[json.member("shape").one_of(names)];
  if (shape == "box") {
    allow_fields(json, {"shape", "size"});
    const auto size = json.optional_member("size");
    return make_box(size ? read_sizes(*size, 3) : Vec3d(1, 1, 1));
  }
  if (shape == "plane") {
    allow_fields(json, {"shape", "size"});
    const auto size = json.optional_member("size");
    const Vec3d sides = size ? read_sizes(*size, 2) : Vec3d(1, 1, 0);
    return make_plane(sides.x, sides.y);
  }
  if (shape == "sphere" || shape == "disc") {
    allow_fields(json, {"shape", "radius", "segments"});
    const double radius = size_of(json, "radius", 1);
    const int segments = segments_of(json);
    return shape == "sphere" ? make_sphere(radius, segments) : make_disc(radius, segments);
  }
  if (shape == "torus") {
    allow_fields(json, {"shape", "radius", "thickness", "segments"});
    const double radius = size_of(json, "radius", 1);
    const double thickness = size_of(json, "thickness", radius / 4);
    if (thickness >= 2 * radius) {
      json.member("thickness").fail("less than the diameter " + std::to_string(2 * radius));
    }
    return make_torus(radius, thickness, segments_of(json));
  }
  allow_fields(json, {"shape", "radius", "height", "segments"});
  const double radius = size_of(json, "radius", 1);
  const double height = size_of(json, "height", 1);
  return shape == "cone" ? make_cone(radius, height, segments_of(json))
                         : make_cylinder(radius, height, segments_of(json));
}

Quaternion read_rotation(const JsonReader& json) {
  constexpr double kDegree = std::numbers::pi / 180;
  if (json.is_array()) {
    const std::vector<double> turn = json.numbers(3, -360, 360);
    return axis_angle({0, 0, 1}, turn[2] * kDegree) * axis_angle({0, 1, 0}, turn[1] * kDegree) *
           axis_angle({1, 0, 0}, turn[0] * kDegree);
  }
  json.allow_only({"axis", "angle"});
  const JsonReader axis_field = json.member("axis");
  const Vec3d axis = read_point(axis_field);
  if (!(length(axis) > 1e-9)) axis_field.fail("an axis that is not zero");
  return axis_angle(axis, json.member("angle").number(-360, 360) * kDegree);
}

/// Scale, then rotation: what comes before "fit".
Transform read_shape_transform(const JsonReader& json) {
  Transform result;
  if (const auto scale = json.optional_member("scale")) {
    const Vec3d by = scale->is_array() ? read_sizes(*scale, 3)
                                       : Vec3d::filled(scale->number(kSmallest, kLargest));
    result = scaling(by);
  }
  if (const auto rotate = json.optional_member("rotate")) {
    result = rotation(read_rotation(*rotate)) * result;
  }
  return result;
}

/// Makes the meshes as tall or as long as asked for, and stands them on y = 0 around the y axis.
Transform fit_transform(const JsonReader& json, const std::vector<Mesh>& meshes) {
  json.allow_only({"height", "longest"});
  if (json.has("height") == json.has("longest")) json.fail("either \"height\" or \"longest\"");
  const Bounds bounds = bounds_of(meshes);
  const Vec3d sides = bounds.high - bounds.low;
  const bool by_height = json.has("height");
  const double wanted = json.member(by_height ? "height" : "longest").number(kSmallest, kLargest);
  const double present = by_height ? sides.y : max_component(sides);
  if (!(present > 0)) {
    throw Error(json.where(), "an object without a height", "an object that is not flat");
  }
  const Vec3d middle = (bounds.low + bounds.high) * 0.5;
  return scaling(Vec3d::filled(wanted / present)) *
         translation({-middle.x, -bounds.low.y, -middle.z});
}

void check_range(const JsonReader& json, const Mesh& mesh) {
  for (const Vec3f& p : mesh.positions) {
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(p[axis]) <= kFarthest) continue;
      throw Error(json.where(), "the coordinate " + std::to_string(p[axis]),
                  "coordinates within ±1e9");
    }
  }
}

/// What a file's normals are: its own, none, or smooth ones. Shapes keep theirs.
enum class Normals { own, flat, smooth };

Normals read_normals(const JsonReader& json) {
  constexpr Normals kChoices[] = {Normals::own, Normals::flat, Normals::smooth};
  const auto field = json.optional_member("normals");
  return field ? kChoices[field->one_of({"own", "flat", "smooth"})] : Normals::own;
}

void set_normals(Normals normals, std::vector<Mesh>& meshes) {
  for (Mesh& mesh : meshes) {
    if (normals == Normals::flat) mesh.normals.clear();
    if (normals == Normals::smooth) smooth_normals(mesh);
  }
}

MeshFile read_file_object(const JsonReader& json, const ObjectContext& context) {
  allow_fields(json, {"file", "normals"});
  const JsonReader file = json.member("file");
  const auto materials = json.has("material") ? FileMaterials::ignore : FileMaterials::read;
  try {
    return read_mesh_file(context.folder / file.string(), materials);
  } catch (const Error& error) {
    throw Error(file.where() + ": " + error.where(), error.found(), error.expected());
  }
}

std::uint32_t material_of(const JsonReader& field, const ObjectContext& context) {
  std::vector<std::string> names;
  for (const auto& [name, index] : context.material_named) names.push_back(name);
  if (names.empty()) field.fail("no material: the scene has none, see \"materials\"");
  return context.material_named.at(names[field.one_of(names)]);
}

void check_triangle_count(const JsonReader& json, const Scene& scene) {
  std::size_t triangles = 0;
  for (const Mesh& mesh : scene.meshes) triangles += mesh.triangles.size();
  if (triangles <= kMostTriangles) return;
  throw Error(json.where(), std::to_string(triangles) + " triangles up to here",
              "at most " + std::to_string(kMostTriangles) + " in a scene");
}

/// Gives the meshes the scene's material that the object names, or moves the file's own ones over.
void set_materials(const JsonReader& json, const ObjectContext& context, MeshFile& object,
                   Scene& scene) {
  if (json.has("material") || object.materials.empty()) {
    const std::uint32_t material = material_of(json.member("material"), context);
    for (Mesh& mesh : object.meshes) mesh.material = material;
    return;
  }
  const auto first = static_cast<std::uint32_t>(scene.materials.size());
  for (Mesh& mesh : object.meshes) mesh.material += first;
  std::move(object.materials.begin(), object.materials.end(), std::back_inserter(scene.materials));
}

/// Scale, rotate, fit, translate, in this order.
void place(const JsonReader& json, std::vector<Mesh>& meshes) {
  const Transform shape = read_shape_transform(json);
  for (Mesh& mesh : meshes) apply(shape, mesh);
  Transform transform;
  if (const auto fit = json.optional_member("fit")) transform = fit_transform(*fit, meshes);
  if (const auto translate = json.optional_member("translate")) {
    transform = translation(read_point(*translate)) * transform;
  }
  for (Mesh& mesh : meshes) {
    apply(transform, mesh);
    check_range(json, mesh);
  }
}

}  // namespace

void add_object(const JsonReader& json, const ObjectContext& context, Scene& scene) {
  // Before a file is read that may take a while.
  const Normals normals = read_normals(json);
  MeshFile object;
  if (json.has("file")) {
    object = read_file_object(json, context);
  } else {
    object.meshes.push_back(read_shape(json));
    object.meshes.back().name = json.member("shape").string();
  }
  set_materials(json, context, object, scene);
  place(json, object.meshes);
  std::size_t kept = 0;
  for (Mesh& mesh : object.meshes) {
    scene.dropped_triangles += drop_degenerate_triangles(mesh);
    kept += mesh.triangles.size();
  }
  if (kept == 0) throw Error(json.where(), "only degenerate triangles", "a surface");
  set_normals(normals, object.meshes);
  std::move(object.meshes.begin(), object.meshes.end(), std::back_inserter(scene.meshes));
  check_triangle_count(json, scene);
}

}  // namespace rimlight
