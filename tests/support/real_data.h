#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>

namespace rimlight::test {

/// The folder of real meshes and probes, when there is one, as an absolute path: what RIMLIGHT_DATA
/// names, else ../shared/data.
inline std::optional<std::filesystem::path> real_data() {
  const char* const named = std::getenv("RIMLIGHT_DATA");
  const std::filesystem::path path = named != nullptr && *named != '\0' ? named : "../shared/data";
  if (std::filesystem::is_directory(path / "probes")) return std::filesystem::absolute(path);
  return std::nullopt;
}

}  // namespace rimlight::test
