#include "server/protocol/view_edits.h"

namespace rimlight::server {
namespace {

using nlohmann::json;

constexpr double kFarthest = 1e9;  // as check_camera() has it

Vec3d read_point(const JsonReader& reader) {
  const std::vector<double> v = reader.numbers(3, -kFarthest, kFarthest);
  return {v[0], v[1], v[2]};
}

json to_json(const Vec3d& v) { return {v.x, v.y, v.z}; }

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

json camera_to_json(const Camera& camera) {
  return {{"position", to_json(camera.position)},
          {"target", to_json(camera.target)},
          {"up", to_json(camera.up)},
          {"fov", camera.vertical_field_of_view_degrees}};
}

json view_to_json(const std::optional<Camera>& view) {
  return {{"camera", view ? camera_to_json(*view) : json()}};
}

}  // namespace rimlight::server
