#pragma once

#include <algorithm>
#include <cmath>

#include "core/math/vec.h"

namespace rimlight {

/// The half vector of two unit directions above the surface, local to the shading frame.
struct HalfVector {
  Vec3f sum;           // in + out, not normalized
  float z = 1;         // cos θ_h
  float out_half = 0;  // cos θ_d
  bool exists = false;

  /// tan² θ_h from the sum's own components: 1 − cos² would lose a narrow lobe's digits.
  float tangent_squared() const { return (sum.x * sum.x + sum.y * sum.y) / (sum.z * sum.z); }
};

/// Opposite directions along the surface have no half vector to speak of.
inline HalfVector half_vector(const Vec3f& in, const Vec3f& out) {
  const Vec3f sum = in + out;
  const float squared = dot(sum, sum);
  if (!(squared > 1e-12f)) return {};
  const float scale = 1 / std::sqrt(squared);
  return {sum, sum.z * scale, std::min(1.0f, 0.5f * squared * scale), true};
}

/// The direction that `out` is mirrored to at the unit vector `half`.
inline Vec3f mirrored(const Vec3d& half, const Vec3f& out) {
  const Vec3d o(out);
  return Vec3f(normalized(half * (2 * dot(o, half)) - o));
}

}  // namespace rimlight
