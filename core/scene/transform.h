#pragma once

#include "core/math/rotation.h"
#include "core/math/vec.h"
#include "core/scene/scene.h"

namespace rimlight {

/// An affine map of points: p ↦ linear · p + offset. In double.
struct Transform {
  Matrix3 linear{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vec3d offset;

  Vec3d point(const Vec3d& p) const { return linear * p + offset; }
  /// Normals go by the cofactors of `linear`, so that they stay perpendicular to the surface; not
  /// normalised. Zero where the map flattens the surface along it.
  Vec3d normal(const Vec3d& n) const;
};

Transform translation(const Vec3d& by);
Transform scaling(const Vec3d& by);
Transform rotation(const Quaternion& by);

/// First b, then a.
Transform operator*(const Transform& a, const Transform& b);

/// Moves a mesh's positions and normals; normals stay unit (or zero).
void apply(const Transform& transform, Mesh& mesh);

}  // namespace rimlight
