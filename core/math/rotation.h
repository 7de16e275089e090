#pragma once

#include "core/math/random.h"
#include "core/math/vec.h"

namespace rimlight {

/// A unit quaternion (x, y, z, w): the rotation by angle a about unit axis n is
/// (n sin a/2, cos a/2). It turns vectors: rotated(q, v) = q v q*.
struct Quaternion {
  double x = 0, y = 0, z = 0, w = 1;

  friend constexpr bool operator==(const Quaternion&, const Quaternion&) = default;
};

/// The quaternion that turns by `angle` radians about `axis` (any length but zero).
Quaternion axis_angle(const Vec3d& axis, double angle);

/// First b, then a.
Quaternion operator*(const Quaternion& a, const Quaternion& b);

/// The inverse of a unit quaternion.
constexpr Quaternion conjugate(const Quaternion& q) { return {-q.x, -q.y, -q.z, q.w}; }

double norm(const Quaternion& q);

/// q / |q|. |q| must be finite and positive.
Quaternion normalized(const Quaternion& q);

/// Uniformly distributed over all rotations (Shoemake 1992).
Quaternion random_rotation(Random& random);

/// A 3×3 matrix of rows, for turning many vectors.
struct Matrix3 {
  Vec3d row[3];

  Vec3d operator*(const Vec3d& v) const { return {dot(row[0], v), dot(row[1], v), dot(row[2], v)}; }
};

/// The matrix of a unit quaternion: matrix(q) * v = rotated(q, v).
Matrix3 matrix(const Quaternion& q);

Vec3d rotated(const Quaternion& q, const Vec3d& v);

}  // namespace rimlight
