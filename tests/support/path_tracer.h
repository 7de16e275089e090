#pragma once

#include "core/basis/cube_map.h"
#include "core/math/random.h"
#include "core/scene/ray_scene.h"

namespace rimlight::test {

/// A plain path tracer, the oracle that bakes are held against: next-event estimation towards one
/// lit texel of a cube map (radiance 1), BRDF sampling, no sharing, no reuse, nothing clever.
class TexelPathTracer {
 public:
  /// `bounces` interreflections at most, as in BakeSettings. The scene must outlive it.
  TexelPathTracer(const RayScene& scene, int cube_size, std::size_t texel, int bounces);

  /// One sample of a pixel's radiance under the lit texel (background black).
  Vec3f sample_pixel(int x, int y, Random& random) const;

 private:
  /// Light straight from the texel to a surface point, one sample.
  Vec3f direct(const SurfaceHit& hit, const Vec3f& out, Random& random) const;

  const RayScene& scene_;
  int cube_size_;
  std::size_t texel_;
  int bounces_;
};

}  // namespace rimlight::test
