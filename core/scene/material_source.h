#pragma once

#include <filesystem>

#include "core/base/json_reader.h"
#include "core/math/vec.h"
#include "core/scene/scene.h"

namespace rimlight {

/// Parts of the scene source (docs/formats/scene.md); errors as read_scene's.

/// A point or direction: three numbers, each within ±1e6.
Vec3d read_point(const JsonReader& json);

/// One number for all three channels, or three.
Vec3f read_channels(const JsonReader& json, double low, double high);

/// One entry of "materials"; its texture is relative to `folder`.
Material read_material(const JsonReader& json, const std::string& name,
                       const std::filesystem::path& folder);

}  // namespace rimlight
