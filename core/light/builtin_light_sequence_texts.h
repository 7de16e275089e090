#pragma once

#include <span>
#include <string_view>

namespace rimlight {

/// A file of configs/sequences as it was at build time.
struct BuiltinLightSequenceText {
  std::string_view name;  // the file's, without its ending
  std::string_view text;
};

/// All of them, sorted by name.
std::span<const BuiltinLightSequenceText> builtin_light_sequence_texts();

}  // namespace rimlight
