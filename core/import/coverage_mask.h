#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rimlight {

/// The share of each pixel that imported transport covers; what is left shows the environment.
struct CoverageMask {
  std::string source;  // stands in errors
  int width = 0;
  int height = 0;
  std::vector<float> shares;  // [height][width], in [0, 1]
};

/// A mask's red channel: of a .png its bytes by 255 (no sRGB curve), of an .exr its values, clamped
/// to [0, 1]. Throws Error.
CoverageMask read_mask(const std::filesystem::path& path);

}  // namespace rimlight
