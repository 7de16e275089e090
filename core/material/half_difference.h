#pragma once

#include "core/math/vec.h"

namespace rimlight {

/// Rusinkiewicz's angles (1998) of two directions above an isotropic surface, in radians: the half
/// vector's polar angle, and the polar and azimuthal angle of ω_i in the frame whose pole is the
/// half vector, counted from the plane of the half vector and the normal.
struct HalfDifference {
  double half = 0;        // θ_h in [0, π/2]
  double difference = 0;  // θ_d in [0, π/2]
  double azimuth = 0;     // φ_d in (−π, π]; exchanging both directions adds π
};

/// Unit directions in the shading frame (normal = +z).
struct DirectionPair {
  Vec3d in, out;
};

/// Directions that are opposite have θ_h = θ_d = π/2. Angles keep their digits where they are
/// small.
HalfDifference half_difference(const Vec3d& in, const Vec3d& out);

/// The pair whose half vector lies in the x–z plane (x ≥ 0); one or both may lie below the horizon.
DirectionPair direction_pair(const HalfDifference& angles);

}  // namespace rimlight
