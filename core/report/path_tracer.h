#pragma once

#include <cstdint>
#include <vector>

#include "core/image/image.h"
#include "core/light/cube_light.h"
#include "core/math/sampling.h"
#include "core/scene/ray_scene.h"

namespace rimlight {

/// Draws directions from a cube map of constant texels, by their luminance and solid angle.
class TexelSampler {
 public:
  /// A black light gives every texel its solid angle's share.
  explicit TexelSampler(const CubeLight& texels);

  struct Drawn {
    Vec3f direction;
    Vec3f radiance;
    float density = 0;  // per solid angle
  };
  /// `choice` in [0, 1) picks the texel, `at` the place in it.
  Drawn draw(double choice, const Sample2& at) const;
  /// The density with which draw() gives a direction, and the radiance from there.
  float density(const Vec3f& direction) const;
  Vec3f radiance(const Vec3f& direction) const;

 private:
  float density(std::size_t texel, double x, double y) const;

  const CubeLight& texels_;
  std::vector<double> cumulative_;  // of the shares, [texel_count(size)]; the last is 1
};

/// A progressive path tracer, what a user would have without a bake: next-event estimation towards
/// the light's texels and BRDF sampling, weighted by the balance heuristic (Veach and Guibas 1995),
/// shadow rays in streams, Russian roulette. The light is the bake's, texel by texel, so that both
/// aim at the same picture.
class PathTracer {
 public:
  /// `bounces` interreflections at most, as in BakeSettings; 0: direct light. All must outlive it.
  PathTracer(const RayScene& scene, const CubeLight& texels, int bounces);

  /// One path through every pixel of the scene's picture, box-filtered, added to `sum`
  /// [height][width]: radiance of surfaces, black where the camera sees the light itself. Computes
  /// on all cores; the same bits for the same seed and pass.
  void add_pass(std::uint64_t seed, std::uint64_t pass, RgbImage& sum) const;

 private:
  class Tile;

  const RayScene& scene_;
  TexelSampler sampler_;
  int bounces_;
};

}  // namespace rimlight
