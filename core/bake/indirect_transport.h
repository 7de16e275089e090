#pragma once

#include <cstdint>
#include <memory>

#include "core/bake/group.h"
#include "core/scene/ray_scene.h"

namespace rimlight {

struct IndirectSettings {
  int cube_size = 32;
  int bounces = 4;  // most interreflections between the first surface and the sky; 0: none
  /// Texels a side of the cube map that carries indirect light whose last scattering is not glossy:
  /// only the bands below it hold it, so that its noise does not fill the fine ones. At most
  /// cube_size.
  int coarse_size = 8;
  int first_rays = 48;  // shadow rays from each second point that is not Lambert
  int later_rays = 8;   // and from each such point after it
};

/// Light that reaches a pixel's surfaces by way of others. A group's 64 pixels share their second
/// surface points: the k-th primary hits of all pixels make a layer; each samples one second point
/// by its BRDF; then every pixel of the layer gathers from every point of the layer, weighted by
/// the balance heuristic over the 64 ways in which the point could have been made (Veach and Guibas
/// 1995), with the visibility of each pair traced. This is unbiased, and each pixel has 64 times
/// the points it paid for. From each second point a path goes on by BRDF sampling with Russian
/// roulette. Shadow rays from its points deposit on the texel (last scattering glossy, directions
/// drawn by the BRDF) or on the coarse texel (a ray to each of them in turn, which the points share
/// out) that they escape through.
class IndirectTransport {
 public:
  IndirectTransport(const RayScene& scene, const IndirectSettings& settings);
  ~IndirectTransport();

  /// Adds the indirect transport of a group to its rows. Any thread; the result depends on samples
  /// and seed alone.
  void add(const GroupSamples& samples, std::uint64_t seed, GroupRows& rows) const;

 private:
  const RayScene& scene_;
  IndirectSettings settings_;
};

}  // namespace rimlight
