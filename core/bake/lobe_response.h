#pragma once

#include "core/bake/group_surfaces.h"
#include "core/bake/texel_quadrature.h"

namespace rimlight {

/// The smooth factor of the direct transport of a surface with a lobe:
/// share · ∫ f(ω, ω_o) cos⁺θ dω over a texel by one point a quarter, each for the hit that stands
/// for it; a point below either normal's horizon counts nothing.
Vec3f lobe_response(const LobeSurface& lobe, const Quarters& quarters);

/// Of the lanes that face a texel, those that respond to it: all Lambert surfaces, and lobes whose
/// response is not zero.
LaneSet responding_lanes(const GroupSurfaces& surfaces, std::size_t layer, const Quarters& quarters,
                         LaneSet facing);

}  // namespace rimlight
