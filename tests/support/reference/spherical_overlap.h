#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "core/basis/cube_map.h"
#include "core/math/rotation.h"

namespace rimlight::reference {

/// A convex polygon on the sphere with edges along great circles, counter-clockwise seen from
/// outside. Corners need no unit length.
using SphericalPolygon = std::vector<Vec3d>;

/// A texel's outline.
inline SphericalPolygon texel_outline(std::size_t texel, int size) {
  const int index = static_cast<int>(texel);
  const int face = index / (size * size), row = index / size % size, column = index % size;
  const auto corner = [&](int i, int j) {
    return cube::direction({face, 2.0 * (column + i) / size - 1, 2.0 * (row + j) / size - 1});
  };
  return {corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
}

inline SphericalPolygon rotated(const Quaternion& rotation, SphericalPolygon polygon) {
  for (Vec3d& corner : polygon) corner = rimlight::rotated(rotation, corner);
  return polygon;
}

/// What both cover (Sutherland and Hodgman 1974, with great circles for lines).
inline SphericalPolygon clipped(SphericalPolygon subject, const SphericalPolygon& window) {
  for (std::size_t i = 0; i < window.size() && !subject.empty(); ++i) {
    const Vec3d inward = cross(window[i], window[(i + 1) % window.size()]);
    SphericalPolygon kept;
    for (std::size_t k = 0; k < subject.size(); ++k) {
      const Vec3d &a = subject[k], &b = subject[(k + 1) % subject.size()];
      const double da = dot(a, inward), db = dot(b, inward);
      if (da >= 0) kept.push_back(a);
      if ((da > 0 && db < 0) || (da < 0 && db > 0)) {
        kept.push_back((a * std::abs(db) + b * std::abs(da)) / (std::abs(da) + std::abs(db)));
      }
    }
    subject = std::move(kept);
  }
  return subject;
}

/// As a fan of triangles, each by Van Oosterom and Strackee 1983: tan(Ω/2) = a·(b×c) / (1 + …).
inline double solid_angle(const SphericalPolygon& polygon) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    const Vec3d a = normalized(polygon[0]), b = normalized(polygon[i]),
                c = normalized(polygon[i + 1]);
    sum += 2 * std::atan2(dot(a, cross(b, c)), 1 + dot(a, b) + dot(b, c) + dot(c, a));
  }
  return sum;
}

}  // namespace rimlight::reference
