#pragma once

#include <cstdint>
#include <vector>

#include "core/bake/group_surfaces.h"
#include "core/bake/shadow_ray_kernel.h"
#include "core/bake/texel_quadrature.h"
#include "core/base/aligned_vector.h"
#include "core/scene/ray_scene.h"

namespace rimlight {

/// Of the shadow rays of a group, in the order in which they are traced: high unless its pixels
/// show many surfaces, as foliage does.
Coherence shadow_ray_coherence(const GroupSurfaces& surfaces);

/// How much of each texel of the sky the surfaces of a group see, by shadow rays: one to each texel
/// that a surface responds to, and kMoreShadowRays more where the first ones around it disagree
/// (surroundings.h). Reused from group to group, so that it stops allocating. One thread at a time.
class SkyVisibility {
 public:
  static constexpr int kMoreShadowRays = 4;

  /// Begins a group: no surface responds to anything yet.
  void clear(std::size_t layer_count, const TexelQuadrature& texels);

  /// Which surfaces of a layer ask for a texel's visibility: to be set before trace().
  LaneSet& responding(std::size_t layer, std::size_t texel) {
    return responding_[place(layer, texel)];
  }
  LaneSet responding(std::size_t layer, std::size_t texel) const {
    return responding_[place(layer, texel)];
  }

  /// Casts the rays of the group's surfaces; `seed` as for add_shadow_rays().
  void trace(const RayScene& scene, const GroupSurfaces& surfaces, const TexelQuadrature& texels,
             std::uint64_t seed);

  /// The surfaces with 1 + kMoreShadowRays rays to the texel, instead of one.
  LaneSet refined(std::size_t layer, std::size_t texel) const {
    return refined_[place(layer, texel)];
  }
  /// [lane] How many of the rays escaped; 64-byte aligned.
  const std::uint8_t* lit_rays(std::size_t layer, std::size_t texel) const {
    return lit_rays_.data() + place(layer, texel) * kGroupLanes;
  }
  /// The part of the rays that escaped.
  float visibility(std::size_t layer, std::size_t texel, std::size_t lane) const {
    const bool more = (refined(layer, texel) & lane_bit(lane)) != 0;
    return lit_rays(layer, texel)[lane] * (more ? kRefinedWeight : 1);
  }
  static constexpr float kRefinedWeight = 1.0f / (1 + kMoreShadowRays);

 private:
  std::size_t place(std::size_t layer, std::size_t texel) const {
    return layer * texel_count_ + texel;
  }
  void find_refined(int cube_size);
  void cast(const RayScene& scene, const GroupSurfaces& surfaces, const TexelQuadrature& texels,
            const std::vector<LaneSet>& lanes, int first, int count);
  void collect(const RayScene& scene);

  std::size_t layer_count_ = 0;
  std::size_t texel_count_ = 0;
  std::vector<LaneSet> responding_, refined_;  // [layer][texel]
  AlignedVector<std::uint8_t> lit_rays_;       // [layer][texel][lane]
  std::vector<LaneSet> lit_, dark_, mixed_;    // [texel], of all layers together
  std::uint64_t seed_ = 0;
  Coherence coherence_ = Coherence::low;
  ShadowRays rays_;
  std::array<std::uint8_t, SkyRays::kCapacity> visible_{};
};

}  // namespace rimlight
