#include "core/math/rotation.h"

#include <cmath>
#include <numbers>

namespace rimlight {

Quaternion axis_angle(const Vec3d& axis, double angle) {
  const Vec3d n = normalized(axis) * std::sin(angle / 2);
  return {n.x, n.y, n.z, std::cos(angle / 2)};
}

Quaternion operator*(const Quaternion& a, const Quaternion& b) {
  return {
      a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
      a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}

double norm(const Quaternion& q) { return std::hypot(std::hypot(q.x, q.y), std::hypot(q.z, q.w)); }

Quaternion normalized(const Quaternion& q) {
  const double n = norm(q);
  return {q.x / n, q.y / n, q.z / n, q.w / n};
}

Quaternion random_rotation(Random& random) {
  const double u = random.uniform();
  const double a = 2 * std::numbers::pi * random.uniform();
  const double b = 2 * std::numbers::pi * random.uniform();
  const double r = std::sqrt(1 - u);
  const double s = std::sqrt(u);
  return {r * std::sin(a), r * std::cos(a), s * std::sin(b), s * std::cos(b)};
}

Matrix3 matrix(const Quaternion& q) {
  const double xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z;
  const double xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z;
  const double wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
  return {{{1 - 2 * (yy + zz), 2 * (xy - wz), 2 * (xz + wy)},
           {2 * (xy + wz), 1 - 2 * (xx + zz), 2 * (yz - wx)},
           {2 * (xz - wy), 2 * (yz + wx), 1 - 2 * (xx + yy)}}};
}

Vec3d rotated(const Quaternion& q, const Vec3d& v) { return matrix(q) * v; }

}  // namespace rimlight
