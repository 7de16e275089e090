#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/light/light_sequence.h"

namespace rimlight {

/// Reads a light sequence (docs/formats/light_sequence.md,
/// docs/formats/light_sequence.schema.json): JSON, comments allowed; files are named relative to
/// it, and not opened here. Throws Error naming the file and the JSON pointer, found and expected.
LightSequence read_light_sequence(const std::filesystem::path& path);

/// The same from text, with files relative to `folder`; `source` stands in errors, and gives a
/// sequence without a name its own.
LightSequence parse_light_sequence(std::string_view text, const std::string& source,
                                   const std::filesystem::path& folder);

/// The sequences that are always at hand, those of configs/sequences: "area-light", "blend",
/// "flicker", "paint", "rotation" (the rotation of Overbeck 2006, chapters 5 and 6).
const std::vector<std::string>& builtin_light_sequence_names();

/// A built-in sequence by name, or a file: what ends in .json. Throws Error naming `from`, as
/// "--sequence", when it is neither.
LightSequence find_light_sequence(const std::string& name_or_file, const std::string& from);

}  // namespace rimlight
