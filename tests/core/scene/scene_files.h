#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include "tests/support/temporary_folder.h"

namespace rimlight {

inline std::filesystem::path write(const test::TemporaryFolder& folder, const std::string& name,
                                   std::string_view text) {
  std::ofstream(folder / name, std::ios::binary) << text;
  return folder / name;
}

/// The folder of real meshes and probes, when there is one.
inline std::optional<std::filesystem::path> real_data() {
  const char* variable = std::getenv("RIMLIGHT_DATA");
  const std::filesystem::path path = variable != nullptr ? variable : "../shared/data";
  if (std::filesystem::exists(path)) return path;
  return std::nullopt;
}

}  // namespace rimlight
