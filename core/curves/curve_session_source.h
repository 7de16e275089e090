#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/curves/curve_session.h"

namespace rimlight {

/// Reads a session of curve edits (docs/formats/curve_session.md): JSON, comments allowed. Throws
/// Error naming the file and the JSON pointer, found and expected.
CurveSession read_curve_session(const std::filesystem::path& path);

/// The same from text; `source` stands in errors, and gives a session without a name its own.
CurveSession parse_curve_session(std::string_view text, const std::string& source);

/// The sessions that are always at hand, those of configs/edits: "pearl" (Overbeck 2006, figure
/// 3.1).
const std::vector<std::string>& builtin_curve_session_names();

/// A built-in session by name, or a file: what ends in .json. Throws Error naming `from`, as
/// "--session", when it is neither.
CurveSession find_curve_session(const std::string& name_or_file, const std::string& from);

}  // namespace rimlight
