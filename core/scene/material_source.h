#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/json_reader.h"
#include "core/math/vec.h"
#include "core/scene/scene.h"

namespace rimlight {

/// Parts of the scene source (docs/formats/scene.md); errors as read_scene's.

/// A name of 1 to 200 bytes.
std::string read_name(const JsonReader& json);

/// A point or direction: three numbers, each within ±1e6.
Vec3d read_point(const JsonReader& json);

/// One number for all three channels, or three.
Vec3f read_channels(const JsonReader& json, double low, double high);

/// One entry of "materials"; its files are relative to `folder`. `measured` are the scene's, to
/// which a material may add its own.
Material read_material(const JsonReader& json, const std::string& name,
                       const std::filesystem::path& folder,
                       std::vector<MeasuredReflection>& measured);

}  // namespace rimlight
