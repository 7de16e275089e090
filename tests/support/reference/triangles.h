#pragma once

#include <cstddef>
#include <limits>
#include <optional>

#include "core/math/vec.h"
#include "core/scene/scene.h"

namespace rimlight::reference {

struct TriangleHit {
  std::size_t mesh = 0;
  std::size_t triangle = 0;
  double distance = std::numeric_limits<double>::infinity();
  double u = 0, v = 0;  // weights of the second and third corner
};

/// The nearest hit with 0 < distance < far over all triangles, in double (Möller and Trumbore
/// 1997). Triangles are grown by `margin` of their own size: negative to shrink them.
std::optional<TriangleHit> nearest_hit(const Scene& scene, const Vec3d& origin,
                                       const Vec3d& direction, double margin = 0,
                                       double far = std::numeric_limits<double>::infinity());

}  // namespace rimlight::reference
