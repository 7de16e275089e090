#pragma once

#include <cstdint>

#include "core/bake/group.h"
#include "core/bake/group_surfaces.h"
#include "core/bake/texel_quadrature.h"
#include "core/scene/ray_scene.h"

namespace rimlight {

/// Light that reaches a pixel's surfaces straight from the environment: for each texel t
///
///     M_t = Σ_surfaces share · ( ∫_t f(ω, ω_o) cos⁺θ dω ) · V_t
///
/// A pixel's primary hits are grouped into surfaces (same material, like normals), since their mean
/// response is smooth over t and only the visibility V_t is random: noise in the smooth factor
/// would fill every fine band. The factor is a 2×2 quadrature inside each texel. V_t is the mean of
/// shadow rays from the surface's hits to points spread over the texel: one ray, and four more
/// where the first rays around it disagree, in the texels and in the pixels around. (t's own ray
/// has no say in that, so that the mean stays unbiased.)
class DirectTransport {
 public:
  /// Keeps the scene; `cube_size` is N. Of surfaces of `materials` alone.
  DirectTransport(const RayScene& scene, int cube_size, MaterialSet materials = {});

  /// Adds the direct transport of a group to its rows. Any thread; the result depends on samples
  /// and seed alone.
  void add(const GroupSamples& samples, std::uint64_t seed, GroupRows& rows) const;

 private:
  const RayScene& scene_;
  TexelQuadrature texels_;
  MaterialSet materials_;
};

}  // namespace rimlight
