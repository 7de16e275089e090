#pragma once

#include <vector>

#include "core/bake/group_surfaces.h"
#include "core/bake/sky_visibility.h"
#include "core/bake/texel_quadrature.h"

namespace rimlight {

/// The smooth factor of the direct transport of surfaces with a lobe, and what comes of it. Reused
/// from group to group, so that it stops allocating. One thread at a time.
class LobeResponses {
 public:
  /// Evaluates every lobe surface at the texels that `visibility` has it respond to (because it
  /// faces them), and takes it out where the response is zero.
  void evaluate(const GroupSurfaces& surfaces, const TexelQuadrature& texels,
                SkyVisibility& visibility);

  /// Adds response times visibility to the rows, for the surfaces of evaluate().
  void add(const GroupSurfaces& surfaces, const SkyVisibility& visibility, GroupRows& rows) const;

 private:
  // Of one surface after the other, at the texels that it responds to.
  std::vector<Vec3f> responses_;
};

/// share · ∫ f(ω, ω_o) cos⁺θ dω over a texel by one point a quarter, each for the hit that stands
/// for it; a point below either normal's horizon counts nothing.
Vec3f lobe_response(const GroupSurfaces& surfaces, const LobeSurface& lobe,
                    const Quarters& quarters);

}  // namespace rimlight
