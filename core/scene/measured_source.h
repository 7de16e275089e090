#pragma once

#include <filesystem>
#include <vector>

#include "core/base/json_reader.h"
#include "core/scene/scene.h"

namespace rimlight {

/// The field "measured" of a scene source: files of measured BRDFs, read and factorized. Errors as
/// read_scene's, naming the file.
std::vector<MeasuredReflection> read_measured_list(const JsonReader& json,
                                                   const std::filesystem::path& folder);

/// The measured BRDF that a material of the model "measured" names: one of `all`, or a file that is
/// added to them.
const MeasuredReflection& read_measured_of_material(const JsonReader& material,
                                                    const std::filesystem::path& folder,
                                                    std::vector<MeasuredReflection>& all);

}  // namespace rimlight
