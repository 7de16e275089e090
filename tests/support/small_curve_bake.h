#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/transport/bake_folder.h"
#include "tests/support/small_bake.h"

namespace rimlight::test {

/// A bake of kind brdf_curve with a material of each model and a measured one, two measured BRDFs,
/// and random surfaces in all tiles of the picture.
struct CurveBakeParts {
  explicit CurveBakeParts(std::uint64_t seed = 1);
  CurveBakeParts(const CurveBakeParts&) = delete;
  CurveBakeParts& operator=(const CurveBakeParts&) = delete;

  CurveReceivers receivers() const;

  SmallBake settings{.cube_size = 8};
  BakeManifest manifest;
  std::vector<CurveSurface> surfaces;
  std::vector<std::vector<std::uint8_t>> fifths;  // [surface][texel]
  SkyVisibilityPacker sky;
};

/// Of one surface: blocks that see all, nothing, or something of each of their texels.
std::vector<std::uint8_t> random_fifths(int cube_size, std::uint64_t seed);

void write_curve_bake(const std::filesystem::path& folder, const CurveBakeParts& parts);

}  // namespace rimlight::test
