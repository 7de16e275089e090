#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "core/base/json_reader.h"
#include "core/scene/scene.h"

namespace rimlight {

/// What objects of the scene source are read with.
struct ObjectContext {
  std::filesystem::path folder;                         // files are relative to it
  std::map<std::string, std::uint32_t> material_named;  // positions in Scene::materials
};

/// Reads one entry of "objects" (a file or a shape, not a builtin) and adds its meshes, and
/// materials that come with it, to the scene. Errors as read_scene's.
void add_object(const JsonReader& json, const ObjectContext& context, Scene& scene);

}  // namespace rimlight
