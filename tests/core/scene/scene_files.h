#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "tests/support/real_data.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {

inline std::filesystem::path write(const test::TemporaryFolder& folder, const std::string& name,
                                   std::string_view text) {
  std::ofstream(folder / name, std::ios::binary) << text;
  return folder / name;
}

using test::real_data;

}  // namespace rimlight
