#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "core/scene/scene.h"

namespace rimlight {

struct Ray {
  Vec3f origin;
  Vec3f direction;  // unit
};

/// A point of a surface, ready for shading. Normals are on the side that the ray came from.
struct SurfaceHit {
  Vec3f position;
  Vec3f geometric_normal;
  Vec3f shading_normal;
  float distance = 0;
  Brdf brdf;         // the texture looked up
  float offset = 0;  // move rays' origins this far along geometric_normal to leave the surface
};

/// The scene in Embree, ready for rays. The tree is built by one thread with fixed settings, so
/// that the same scene gives the same hits. Immutable; any thread.
class RayScene {
 public:
  explicit RayScene(std::shared_ptr<const Scene> scene);
  ~RayScene();

  const Scene& scene() const;
  /// The longest side of the scene's bounding box.
  float extent() const;

  std::optional<SurfaceHit> intersect(const Ray& ray) const;

  /// For each ray whether nothing is hit before `far` (infinity for the sky): visible[i] = 1 or 0.
  /// Rays go to Embree as one incoherent stream (rtcOccluded1M) in batches; ray i's end is far[i],
  /// or infinity when `far` is empty. Far the fastest way for many rays.
  void visible(std::span<const Ray> rays, std::span<const float> far,
               std::span<std::uint8_t> visible) const;

  /// A point to start a ray from `hit` towards `direction`, clear of the surface.
  static Vec3f ray_origin(const SurfaceHit& hit, const Vec3f& direction);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rimlight
