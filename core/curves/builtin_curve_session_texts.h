#pragma once

#include <span>
#include <string_view>

namespace rimlight {

/// A file of configs/edits as it was at build time.
struct BuiltinCurveSessionText {
  std::string_view name;  // the file's, without its ending
  std::string_view text;
};

/// All of them, sorted by name.
std::span<const BuiltinCurveSessionText> builtin_curve_session_texts();

}  // namespace rimlight
