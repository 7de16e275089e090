#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/bake/group.h"

namespace rimlight {

/// Primary hits of one pixel that look alike: one material (albedo averaged), normals within about
/// 18°.
struct PixelSurface {
  std::uint32_t material = 0;  // of the scene
  Brdf brdf;                   // with the mean albedo of its hits
  std::vector<const SurfaceHit*> hits;
  std::vector<Vec3f> outgoing;  // beside each hit
  float share = 0;              // of the pixel's primary rays
  Vec3f normal_sum;
};

/// At most kMostSurfaces surfaces, whose memory is kept from pixel to pixel.
inline constexpr std::size_t kMostSurfaces = 4;
class PixelSurfaces {
 public:
  std::size_t size() const { return count_; }
  const PixelSurface& operator[](std::size_t i) const { return surfaces_[i]; }
  PixelSurface* begin() { return surfaces_.data(); }
  PixelSurface* end() { return surfaces_.data() + count_; }
  const PixelSurface* begin() const { return surfaces_.data(); }
  const PixelSurface* end() const { return surfaces_.data() + count_; }

  void clear() { count_ = 0; }
  /// One more surface, without hits. There must be less than kMostSurfaces.
  PixelSurface& add();

 private:
  std::array<PixelSurface, kMostSurfaces> surfaces_;
  std::size_t count_ = 0;
};

/// Groups a lane's hits into surfaces; when there are kMostSurfaces, later odd hits join the
/// nearest. The surfaces point into `samples`.
void find_surfaces(const GroupSamples& samples, std::size_t lane, PixelSurfaces& surfaces);

}  // namespace rimlight
