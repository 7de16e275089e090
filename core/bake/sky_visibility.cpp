#include "core/bake/sky_visibility.h"

#include <cstring>

#include "core/bake/surroundings.h"

namespace rimlight {
namespace {

/// The lanes whose byte is 1; the others' are 0.
LaneSet lanes_of_ones(const std::uint8_t* bytes) {
  // Moves the lowest bit of byte i to bit 56 + i; the products of no two bytes meet.
  constexpr std::uint64_t kGather = 0x0102'0408'1020'4080;
  LaneSet lanes = 0;
  for (std::size_t i = 0; i < kGroupLanes; i += 8) {
    std::uint64_t eight;
    std::memcpy(&eight, bytes + i, sizeof eight);
    lanes |= ((eight * kGather) >> 56) << i;
  }
  return lanes;
}

}  // namespace

Coherence shadow_ray_coherence(const GroupSurfaces& surfaces) {
  // On the terrace, this rule's choices take 2 % longer than the better way for each group would.
  constexpr float kMostSurfacesPerPixel = 1.7f;
  return surfaces.surfaces_per_pixel() < kMostSurfacesPerPixel ? Coherence::high : Coherence::low;
}

void SkyVisibility::clear(std::size_t layer_count, const TexelQuadrature& texels) {
  layer_count_ = layer_count;
  texel_count_ = texels.count();
  const std::size_t count = layer_count_ * texel_count_;
  responding_.assign(count, 0);
  refined_.assign(count, 0);
  lit_rays_.assign(count * kGroupLanes, 0);
}

void SkyVisibility::trace(const RayScene& scene, const GroupSurfaces& surfaces,
                          const TexelQuadrature& texels, std::uint64_t seed) {
  seed_ = seed;
  coherence_ = shadow_ray_coherence(surfaces);
  cast(scene, surfaces, texels, responding_, 0, 1);
  find_refined(texels.cube_size());
  cast(scene, surfaces, texels, refined_, 1, kMoreShadowRays);
}

void SkyVisibility::find_refined(int cube_size) {
  lit_.assign(texel_count_, 0);
  dark_.assign(texel_count_, 0);
  mixed_.resize(texel_count_);
  for (std::size_t layer = 0; layer < layer_count_; ++layer) {
    for (std::size_t texel = 0; texel < texel_count_; ++texel) {
      const LaneSet lit = lanes_of_ones(lit_rays(layer, texel));
      lit_[texel] |= lit;
      dark_[texel] |= responding(layer, texel) & ~lit;
    }
  }
  find_mixed_surroundings(cube_size, lit_, dark_, mixed_);
  for (std::size_t layer = 0; layer < layer_count_; ++layer) {
    for (std::size_t texel = 0; texel < texel_count_; ++texel) {
      refined_[place(layer, texel)] = responding(layer, texel) & mixed_[texel];
    }
  }
}

/// Texel by texel, so that rays that follow each other are nearly parallel and start nearby.
void SkyVisibility::cast(const RayScene& scene, const GroupSurfaces& surfaces,
                         const TexelQuadrature& texels, const std::vector<LaneSet>& lanes,
                         int first, int count) {
  const std::size_t most_rays = static_cast<std::size_t>(count) * kGroupLanes;
  for (std::size_t texel = 0; texel < texel_count_; ++texel) {
    const TexelPatch patch = texels.patch(texel);
    for (std::size_t layer = 0; layer < layer_count_; ++layer) {
      const LaneSet wanted = lanes[place(layer, texel)];
      if (wanted == 0) continue;
      if (rays_.rays.count + most_rays > SkyRays::kCapacity) collect(scene);
      const auto slot = static_cast<std::uint32_t>(place(layer, texel) * kGroupLanes);
      add_shadow_rays({surfaces, layer, patch, wanted, first, count, slot, seed_}, rays_);
    }
  }
  collect(scene);
}

void SkyVisibility::collect(const RayScene& scene) {
  scene.visible(rays_.rays, coherence_, visible_);
  for (std::size_t i = 0; i < rays_.rays.count; ++i) {
    std::uint8_t& lit = lit_rays_[rays_.slot[i]];
    lit = static_cast<std::uint8_t>(lit + visible_[i]);
  }
  rays_.rays.count = 0;
}

}  // namespace rimlight
