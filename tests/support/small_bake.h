#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/transport/bake_folder.h"
#include "tests/support/random_transport.h"

namespace rimlight::test {

/// A bake of random transport: no scene, no rays, made in milliseconds.
struct SmallBake {
  PixelLayout pixels{70, 66};  // four tiles, three of them mostly padding
  int cube_size = 4;
  double density = 0.1;
  double lowest = -1;  // of the transport's values: 0 makes an image that is mostly bright
  std::uint64_t seed = 1;
  std::string scene = "small";
};

BakeManifest small_manifest(const SmallBake& settings);
/// Some pixels covered, some not, some half.
std::vector<float> small_coverage(const SmallBake& settings);
/// Of the covered pixels, from 0.1 to 1; 0 where nothing is covered.
std::vector<Vec3f> small_reflectance(const SmallBake& settings);
std::vector<TileTransport> small_tiles(const SmallBake& settings);
/// "sky" (lat-long, 16 × 8, with a bright sun) and "room" (cube faces in a strip, 24 × 4).
std::vector<BakedEnvironment> small_environments();
/// All of it but the commit.
void fill(BakeWriter& writer, const SmallBake& settings);
void write_small_bake(const std::filesystem::path& folder, const SmallBake& settings);

}  // namespace rimlight::test
