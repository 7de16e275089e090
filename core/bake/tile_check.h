#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/math/vec.h"

namespace rimlight {

/// What a baked tile has and is checked against, beside its transport: its coverage, its
/// reflectance, and its image under each check light made from the whole transport, before anything
/// was left out.
struct TileCheck {
  std::vector<float> coverage;             // [4096]
  std::vector<Vec3f> reflectance;          // [4096]
  std::vector<std::vector<Vec3f>> images;  // [check light][4096]
};

/// Kept beside the tile's part while the bake is unfinished; crash-safe as save_part(). Throws
/// Error.
void save_check(const std::filesystem::path& path, const TileCheck& check,
                std::uint64_t fingerprint);

/// Nothing when the file is missing, damaged or of another fingerprint or number of lights.
std::optional<TileCheck> load_check(const std::filesystem::path& path, std::size_t lights,
                                    std::uint64_t fingerprint);

}  // namespace rimlight
