// A curves.safetensors whose hashes are right and whose contents are not: what is taken is
// unpacked.

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "core/basis/cube_map.h"
#include "core/transport/curve_tensors.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

/// One file a process, written again for each input.
const std::filesystem::path& scratch_file() {
  static const std::filesystem::path kPath = std::filesystem::temp_directory_path() /
                                             ("rimlight-curve-fuzz-" + std::to_string(::getpid()));
  return kPath;
}

/// Two materials, one measured BRDF, one tile, the smallest cube map.
rimlight::BakeManifest small_manifest() {
  rimlight::BakeManifest manifest;
  manifest.pixels = {16, 8};
  manifest.cube_size = 8;
  manifest.materials = {{"pearl", {}}, {"gold", {}}};
  manifest.measured_brdfs = {{"silk", {}, rimlight::FactoredBrdf{}}};
  return manifest;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rimlight;
  if (size == 0 || size > kHashedBlock) return 0;
  std::ofstream(scratch_file(), std::ios::binary) << fuzz::text_of(data, size);
  TensorFileSummary summary;
  summary.bytes = size;
  summary.block_hashes.push_back(hash_bytes(fuzz::bytes_of(data, size), 0));
  const int result = fuzz::expect_result_or_error([&] {
    const TensorFile file(scratch_file(), summary);
    BakeManifest manifest = small_manifest();
    const auto surfaces = read_curve_surfaces(file, "input", manifest);
    for (const CurveSurface& surface : surfaces) {
      if (surface.material >= manifest.materials.size()) std::abort();
    }
    const SkyVisibilityView sky = read_sky_visibility(file, "input", manifest, surfaces.size());
    std::vector<std::uint8_t> fifths(cube::texel_count(manifest.cube_size));
    for (std::size_t surface = 0; surface < surfaces.size(); ++surface) {
      sky.unpack(surface, fifths);
      for (const std::uint8_t value : fifths) {
        if (value > SkyVisibilityView::kAll) std::abort();
      }
    }
    read_measured_factors(file, "input", manifest);
  });
  std::filesystem::remove(scratch_file());
  return result;
}
