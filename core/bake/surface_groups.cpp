#include "core/bake/surface_groups.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"

namespace rimlight {
namespace {

bool same_material(const PixelSurface& surface, const SurfaceHit& hit) {
  constexpr float kAlbedoTolerance = 0.1f;  // textures
  const Vec3f difference = surface.brdf.albedo - hit.brdf.albedo;
  return surface.material == hit.material && std::abs(difference.x) <= kAlbedoTolerance &&
         std::abs(difference.y) <= kAlbedoTolerance && std::abs(difference.z) <= kAlbedoTolerance;
}

/// How unlike a hit is to a surface: 0 … 2 by normals, 4 more for another material.
float unlikeness(const PixelSurface& surface, const SurfaceHit& hit) {
  // Opposite normals may cancel: then nothing is alike.
  const float alike =
      dot(surface.normal_sum, hit.shading_normal) / std::max(length(surface.normal_sum), 1e-6f);
  return (same_material(surface, hit) ? 0.0f : 4.0f) + 1 - alike;
}

}  // namespace

PixelSurface& PixelSurfaces::add() {
  RIMLIGHT_CHECK(count_ < kMostSurfaces);
  PixelSurface& surface = surfaces_[count_++];
  surface.hits.clear();
  surface.outgoing.clear();
  surface.share = 0;
  surface.normal_sum = {};
  return surface;
}

void find_surfaces(const GroupSamples& samples, std::size_t lane, PixelSurfaces& surfaces) {
  constexpr float kLikeEnough = 0.05f;  // 1 − cos 18°
  surfaces.clear();
  for (int ray = 0; ray < samples.rays; ++ray) {
    const auto& hit = samples.hit(lane, ray);
    if (!hit) continue;
    PixelSurface* nearest = nullptr;
    float least = 0;
    for (PixelSurface& surface : surfaces) {
      const float value = unlikeness(surface, *hit);
      if (nearest == nullptr || value < least) {
        nearest = &surface;
        least = value;
      }
    }
    if (nearest == nullptr || (least > kLikeEnough && surfaces.size() < kMostSurfaces)) {
      nearest = &surfaces.add();
      nearest->material = hit->material;
      nearest->brdf = hit->brdf;
      nearest->brdf.albedo = {};
    }
    nearest->hits.push_back(&*hit);
    nearest->outgoing.push_back(samples.out(lane, ray));
    nearest->normal_sum += hit->shading_normal;
    // The mean so far, so that later hits compare with it.
    const auto count = static_cast<float>(nearest->hits.size());
    nearest->brdf.albedo += (hit->brdf.albedo - nearest->brdf.albedo) / count;
    nearest->share = count / static_cast<float>(samples.rays);
  }
}

}  // namespace rimlight
