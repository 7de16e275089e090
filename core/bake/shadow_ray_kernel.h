#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/bake/group_surfaces.h"
#include "core/bake/texel_quadrature.h"
#include "core/scene/sky_rays.h"

namespace rimlight {

/// Shadow rays on their way, each with the place where its answer is counted.
struct ShadowRays {
  SkyRays rays;
  alignas(64) std::array<std::uint32_t, SkyRays::kCapacity + SkyRays::kSlack> slot{};
};

/// Which rays: of the surfaces of `lanes` in a layer to a texel, `count` of each from number
/// `first` on; count is a power of two. Lane i's answers go to slot `first_slot` + i, where
/// first_slot is a multiple of 64.
struct ShadowRayRequest {
  const GroupSurfaces& surfaces;
  std::size_t layer = 0;
  TexelPatch texel;
  LaneSet lanes = 0;
  int first = 0, count = 1;
  std::uint32_t first_slot = 0;
  std::uint64_t seed = 0;  // of the group
};

/// Adds the rays, lane by lane; there must be room for count · 64.
///
/// Ray k starts at the k-th hit of a walk over the surface's hits and goes to the k-th point of an
/// R2 sequence over the texel, both from a random begin, so that few rays cover pixel and texel
/// evenly; all follow from seed, layer, lane, texel and k. A ray that would start below
/// either normal's horizon (the texel straddles it) goes to the middle of the quarter that is
/// highest above the shading normal's.
///
/// The random begins are pcg3d (Jarzynski and Olano 2020, JCGT 9(3)) of (texel + low half of the
/// seed, layer · 64 + lane, high half of the seed); the sequence is in 32-bit fixed point, where it
/// wraps by itself. Neighbouring seeds share numbers: mix them first (mix_bits).
void add_shadow_rays(const ShadowRayRequest& request, ShadowRays& rays);

}  // namespace rimlight
