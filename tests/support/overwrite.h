#pragma once

#include <filesystem>
#include <fstream>
#include <string_view>

namespace rimlight::test {

/// Replaces a file's bytes, without waiting for the disk as the product does.
inline void overwrite(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace rimlight::test
