#include "core/transport/vertex_bake_manifest.h"

#include <limits>

#include "core/transport/bake_manifest.h"

namespace rimlight {
namespace {

using nlohmann::json;

constexpr std::size_t kMostMaterials = 100'000;
/// Triangles index vertices with 32 bits.
constexpr std::int64_t kMostVertices = std::numeric_limits<std::uint32_t>::max();
constexpr std::int64_t kMostTriangles = std::int64_t{1} << 32;
/// phong_lobe() takes any; a bake's are those of scene sources.
constexpr double kLargestExponent = 1e5;

json to_json(const Vec3f& v) { return {v.x, v.y, v.z}; }

Vec3f read_shares(const JsonReader& reader) {
  const auto v = reader.numbers(3, 0, 1);
  return Vec3f(Vec3d(v[0], v[1], v[2]));
}

VertexMaterial read_material(const JsonReader& reader) {
  reader.allow_only({"name", "albedo", "highlight", "exponent"});
  return {.name = reader.member("name").string(),
          .albedo = read_shares(reader.member("albedo")),
          .highlight = read_shares(reader.member("highlight")),
          .exponent = reader.member("exponent").number(1, kLargestExponent)};
}

int read_degree(const JsonReader& reader) {
  return static_cast<int>(reader.integer(0, kLargestVertexDegree));
}

std::size_t read_count(const JsonReader& reader, std::int64_t least, std::int64_t most) {
  return static_cast<std::size_t>(reader.integer(least, most));
}

}  // namespace

json to_json(const VertexBakeManifest& manifest, const VertexBakeShape& shape) {
  json materials = json::array();
  for (const VertexMaterial& material : manifest.materials) {
    materials.push_back({{"name", material.name},
                         {"albedo", to_json(material.albedo)},
                         {"highlight", to_json(material.highlight)},
                         {"exponent", material.exponent}});
  }
  return {{"kind", kVertexKind},
          {"scene", manifest.scene},
          {"width", manifest.width},
          {"height", manifest.height},
          {"camera", camera_to_json(manifest.camera)},
          {"vertices", shape.vertices},
          {"triangles", shape.triangles},
          {"highlight_vertices", shape.transport.highlight_count},
          {"irradiance_degree", shape.transport.irradiance_degree},
          {"irradiance_channels", shape.transport.irradiance_channels},
          {"visibility_degree", shape.transport.visibility_degree},
          {"materials", materials},
          {"settings", manifest.settings},
          {"measured", manifest.measured},
          {"left_out", manifest.left_out}};
}

VertexBakeManifest read_vertex_manifest(const JsonReader& reader) {
  expect_kind(reader, kVertexKind);
  reader.allow_only({"version", "kind", "scene", "width", "height", "camera", "vertices",
                     "triangles", "highlight_vertices", "irradiance_degree", "irradiance_channels",
                     "visibility_degree", "materials", "settings", "measured", "left_out",
                     "environments", "files"});
  VertexBakeManifest manifest;
  manifest.scene = reader.member("scene").string();
  manifest.width = read_image_side(reader.member("width"));
  manifest.height = read_image_side(reader.member("height"));
  manifest.camera = read_manifest_camera(reader.member("camera"));
  for (const JsonReader& material : reader.member("materials").elements(1, kMostMaterials)) {
    manifest.materials.push_back(read_material(material));
  }
  manifest.settings = read_object(reader.member("settings"));
  manifest.measured = read_object(reader.member("measured"));
  manifest.left_out = read_object(reader.member("left_out"));
  return manifest;
}

VertexBakeShape read_vertex_shape(const JsonReader& reader) {
  VertexBakeShape shape;
  shape.vertices = read_count(reader.member("vertices"), 1, kMostVertices);
  shape.triangles = read_count(reader.member("triangles"), 1, kMostTriangles);
  shape.transport.vertex_count = shape.vertices;
  shape.transport.highlight_count =
      read_count(reader.member("highlight_vertices"), 0, static_cast<std::int64_t>(shape.vertices));
  shape.transport.irradiance_degree = read_degree(reader.member("irradiance_degree"));
  shape.transport.visibility_degree = read_degree(reader.member("visibility_degree"));
  const JsonReader channels = reader.member("irradiance_channels");
  shape.transport.irradiance_channels = read_count(channels, 0, 3);
  if (shape.transport.irradiance_channels == 2) channels.fail("0, 1 or 3");
  return shape;
}

}  // namespace rimlight
