#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/bake/check_lights.h"
#include "core/bake/tile_store.h"
#include "core/light/cube_light.h"
#include "core/math/vec.h"

namespace rimlight {

/// Each covered receiver under each light, from the stored tiles pruned at `least_energy`: what a
/// bake of them would show. In parallel over tiles; memory: the images and one tile a thread.
LightImages compressed_images(const TileStore& store, std::span<const CubeLight> lights,
                              float least_energy);

/// The same from the check images: made before anything was left out.
LightImages reference_images(const TileStore& store);

/// Display-referred PSNR of each light's image against its reference at its exposure, in dB.
std::vector<double> measure_psnr(const LightImages& images, const LightImages& references,
                                 const std::vector<double>& exposures);

/// The largest least energy of first · 2^(k/4), k = 0 … 16, at which every light still has
/// `psnr_db`; nothing when the first has not.
std::optional<float> choose_least_energy(const TileStore& store, std::span<const CubeLight> lights,
                                         const LightImages& references,
                                         const std::vector<double>& exposures, float first,
                                         double psnr_db);

}  // namespace rimlight
