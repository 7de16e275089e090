#include "core/transport/bake_manifest.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/files.h"
#include "core/basis/cube_map.h"
#include "core/image/image_file.h"
#include "core/transport/curve_tensors.h"

namespace rimlight {
namespace {

using nlohmann::json;

constexpr std::size_t kMostManifestBytes = std::size_t{64} << 20;
constexpr double kFarthest = 1e9;  // scene units

/// In the order of EnvironmentLayout, without `automatic`: a stored layout is decided.
const std::vector<std::string> kLayoutNames = {"lat_long", "angular_map", "cube"};

json to_json(const Vec3d& v) { return {v.x, v.y, v.z}; }

Vec3d read_point(const JsonReader& reader) {
  const auto v = reader.numbers(3, -kFarthest, kFarthest);
  return {v[0], v[1], v[2]};
}

}  // namespace

void expect_kind(const JsonReader& reader, const std::string& expected) {
  const JsonReader kind = reader.member("kind");
  if (kind.string() != expected) kind.fail(quote(expected) + ": a bake of this kind");
}

nlohmann::json camera_to_json(const Camera& camera) {
  return {{"position", to_json(camera.position)},
          {"target", to_json(camera.target)},
          {"up", to_json(camera.up)},
          {"vertical_field_of_view_degrees", camera.vertical_field_of_view_degrees}};
}

Camera read_manifest_camera(const JsonReader& reader) {
  reader.allow_only({"position", "target", "up", "vertical_field_of_view_degrees"});
  Camera camera;
  camera.position = read_point(reader.member("position"));
  camera.target = read_point(reader.member("target"));
  camera.up = read_point(reader.member("up"));
  camera.vertical_field_of_view_degrees =
      reader.member("vertical_field_of_view_degrees").number(0.001, 179.9);
  if (!(length(cross(camera.target - camera.position, camera.up)) > 0)) {
    reader.fail("a target apart from the position and an up apart from the view's axis");
  }
  return camera;
}

int read_image_side(const JsonReader& reader) {
  return static_cast<int>(reader.integer(1, kLargestImageSide));
}

json read_object(const JsonReader& reader) {
  if (!reader.value().is_object()) reader.fail("an object");
  return reader.value();
}

namespace {

int read_cube_size(const JsonReader& reader) {
  const auto size = reader.integer(2, cube::kLargestSize);
  if ((size & (size - 1)) != 0) reader.fail("a power of two");
  return static_cast<int>(size);
}

}  // namespace

json manifest_to_json(const BakeManifest& manifest) {
  json result = {{"version", manifest.version},
                 {"kind", manifest.kind},
                 {"scene", manifest.scene},
                 {"width", manifest.pixels.width},
                 {"height", manifest.pixels.height},
                 {"cube_size", manifest.cube_size},
                 {"camera", camera_to_json(manifest.camera)},
                 {"settings", manifest.settings},
                 {"measured", manifest.measured},
                 {"left_out", manifest.left_out}};
  if (manifest.materials.empty()) return result;
  result["kind"] = kCurveKind;
  result["materials"] = curve_materials_to_json(manifest.materials);
  result["measured_brdfs"] = measured_to_json(manifest.measured_brdfs);
  return result;
}

BakeManifest read_manifest(const JsonReader& reader) {
  // First, so that a later version or another kind is told as such and not by its unknown fields.
  const JsonReader version = reader.member("version");
  if (version.integer(0, INT32_MAX) != kBakeVersion) version.fail(std::to_string(kBakeVersion));
  BakeManifest manifest;
  const JsonReader kind = reader.member("kind");
  const bool has_curves = kind.one_of({kImageKind, kCurveKind}) == 1;
  std::vector<std::string_view> fields = {"version",  "kind",      "scene",        "width",
                                          "height",   "cube_size", "camera",       "settings",
                                          "measured", "left_out",  "environments", "files"};
  if (has_curves) {
    fields.insert(fields.end(), {"materials", "measured_brdfs"});
    manifest.kind = kCurveKind;
    manifest.materials = read_curve_materials(reader.member("materials"));
    manifest.measured_brdfs = read_measured(reader.member("measured_brdfs"));
    check_measured_names(reader.member("materials"), manifest);
  }
  reader.allow_only(fields);
  manifest.scene = reader.member("scene").string();
  manifest.pixels.width = read_image_side(reader.member("width"));
  manifest.pixels.height = read_image_side(reader.member("height"));
  manifest.cube_size = read_cube_size(reader.member("cube_size"));
  manifest.camera = read_manifest_camera(reader.member("camera"));
  manifest.settings = read_object(reader.member("settings"));
  manifest.measured = read_object(reader.member("measured"));
  manifest.left_out = read_object(reader.member("left_out"));
  return manifest;
}

std::string manifest_hash_line(const std::string& manifest_text) {
  return hash_text(hash_bytes(std::as_bytes(std::span(manifest_text)))) + "  " + kManifestFile +
         "\n";
}

std::string read_manifest_text(const std::filesystem::path& folder) {
  std::string text = read_file(folder / kManifestFile, kMostManifestBytes);
  const std::string expected = manifest_hash_line(text);
  const std::string found = read_file(folder / kManifestHashFile, 4096);
  if (found != expected) {
    throw Error((folder / kManifestFile).string(),
                "content that hashes to " + quote(expected.substr(0, 16)),
                "what " + std::string(kManifestHashFile) + " says: " + quote(found));
  }
  return text;
}

const char* layout_name(EnvironmentLayout layout) {
  return kLayoutNames.at(static_cast<std::size_t>(layout) - 1).c_str();
}

EnvironmentLayout read_layout(const JsonReader& reader) {
  return static_cast<EnvironmentLayout>(reader.one_of(kLayoutNames) + 1);
}

bool is_plain_file_name(const std::string& name) {
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
           c == '_' || c == '-';
  };
  return !name.empty() && name.size() <= 200 && name.front() != '.' &&
         std::ranges::all_of(name, is_plain);
}

}  // namespace rimlight
