#pragma once

#include <filesystem>
#include <string_view>

#include "core/scene/scene.h"

namespace rimlight {

/// Reads a scene source (docs/formats/scene.md, docs/formats/scene.schema.json): JSON, comments
/// allowed; files are named relative to it. Throws Error naming the file and the JSON pointer,
/// found and expected.
Scene read_scene(const std::filesystem::path& path);

/// The same from text, with files relative to `folder`; `source` stands in errors.
Scene parse_scene(std::string_view text, const std::string& source,
                  const std::filesystem::path& folder);

}  // namespace rimlight
