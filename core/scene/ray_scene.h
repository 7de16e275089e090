#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "core/scene/scene.h"
#include "core/scene/sky_rays.h"

namespace rimlight {

struct Ray {
  Vec3f origin;
  Vec3f direction;  // unit
};

/// A point of a surface, ready for shading. Surfaces have two sides: both normals are on the side
/// that the ray came from, and the shading normal faces the ray too (bent as little as that needs
/// where a smooth normal looks away).
struct SurfaceHit {
  Vec3f position;
  Vec3f geometric_normal;
  Vec3f shading_normal;
  float distance = 0;
  std::uint32_t material = 0;  // of the scene
  Brdf brdf;                   // the texture looked up
  float offset = 0;  // move rays' origins this far along geometric_normal to leave the surface
  Vec3f tangent;     // the material's where the BRDF is anisotropic, else zero

  /// The frame in which the BRDF's directions are local.
  Frame<float> frame() const { return {shading_normal, tangent}; }
};

/// Where a ray meets a triangle: weights 1 − u − v, u and v of its corners, in their order.
struct TriangleHit {
  std::uint32_t mesh = 0;
  std::uint32_t triangle = 0;
  float u = 0, v = 0;
};

/// Whether rays that follow each other in a stream meet mostly the same parts of the scene.
enum class Coherence { low, high };

/// The scene in Embree, ready for rays. The tree is built by one thread with fixed settings, so
/// that the same scene gives the same hits. Immutable; any thread (with denormals flushed, see
/// core/base/parallel.h). Throws Error when Embree cannot take the scene (memory).
class RayScene {
 public:
  explicit RayScene(std::shared_ptr<const Scene> scene);
  ~RayScene();

  const Scene& scene() const;
  /// The longest side of the scene's bounding box.
  float extent() const;

  std::optional<SurfaceHit> intersect(const Ray& ray) const;

  /// Which triangle a ray meets first, without shading.
  std::optional<TriangleHit> find_triangle(const Ray& ray) const;

  /// For each ray whether nothing is hit before its end: visible[i] = 1 or 0. Ray i's end is
  /// far[i], or infinity (the sky) when `far` is empty; sizes must agree. Rays go to Embree as
  /// incoherent streams (rtcOccluded1M) of fixed size: the fastest way for many rays. Allocates
  /// nothing. Flushes denormals on the calling thread.
  void visible(std::span<const Ray> rays, std::span<const float> far,
               std::span<std::uint8_t> visible) const;

  /// The same for rays to the sky that are already laid out for Embree: visible[i] for the first
  /// `rays.count` of them, for which there must be room. The rays stay as they are.
  ///
  /// Coherent rays go through the tree as packets of 16 on processors with vectors of 16 floats:
  /// 1.6 times as fast where rays that follow each other start nearby and are almost parallel, half
  /// as fast where they are not. Both ways agree but for rays that pass an edge within a rounding
  /// error.
  void visible(SkyRays& rays, Coherence coherence, std::span<std::uint8_t> visible) const;

  /// A point to start a ray from `hit` towards `direction`, clear of the surface.
  static Vec3f ray_origin(const SurfaceHit& hit, const Vec3f& direction);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rimlight
