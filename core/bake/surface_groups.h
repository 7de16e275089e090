#pragma once

#include <array>
#include <vector>

#include "core/bake/group.h"

namespace rimlight {

/// Primary hits of one pixel that look alike: one material (albedo averaged), normals within about
/// 18°.
struct PixelSurface {
  Brdf brdf;  // with the mean albedo of its hits
  std::vector<const SurfaceHit*> hits;
  std::vector<Vec3f> outgoing;  // beside each hit
  float share = 0;              // of the pixel's primary rays
  Vec3f normal_sum;
};

/// Groups a lane's hits into at most kMostSurfaces surfaces; later odd hits join the nearest.
inline constexpr std::size_t kMostSurfaces = 4;
void find_surfaces(const GroupSamples& samples, std::size_t lane,
                   std::vector<PixelSurface>& surfaces);

}  // namespace rimlight
