#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "core/base/json_reader.h"
#include "core/math/camera.h"

namespace rimlight::server {

// The part of edits and states that says where the picture is seen from:
//   view      {"camera": {"position", "target", "up", "fov"}}, or null for the scene's own

/// Throws Error, naming the field: numbers that are not finite or out of range, a camera without
/// rays (check_camera).
std::optional<Camera> read_view(const JsonReader& reader);

nlohmann::json camera_to_json(const Camera& camera);
nlohmann::json view_to_json(const std::optional<Camera>& view);

}  // namespace rimlight::server
