#pragma once

#include <cstdint>

#include "core/bake/group_surfaces.h"
#include "core/bake/texel_quadrature.h"

namespace rimlight {

/// The smooth factor of the direct transport of Lambert surfaces: ∫ cos⁺θ dω over a texel by one
/// point a quarter, each with the normals of the hit that stands for it; a point below either
/// normal's horizon counts nothing.
///
/// The lanes of a layer where it is above 0. (For other BRDFs: that a hit may see the texel.)
LaneSet facing_lanes(const SurfaceLayer& layer, const Quarters& quarters);

/// row[c][lane] += lambert[c][lane] · ∫ cos⁺θ dω · lit_rays[lane] · ray_weight for the 64 lanes,
/// where ray_weight is 1, or `refined_weight` in the lanes of `refined`.
///   row       [3][64], 64-byte aligned
///   lit_rays  [64], 64-byte aligned
struct LitTexel {
  const Quarters& quarters;
  const std::uint8_t* lit_rays;
  LaneSet refined;
  float refined_weight;
};
void add_lambert(const SurfaceLayer& layer, const LitTexel& texel, float* row);

}  // namespace rimlight
