#pragma once

#include <cstddef>
#include <span>

#include "core/math/vec.h"
#include "core/scene/scene.h"

namespace rimlight {

/// Drops triangles that name a vertex twice or whose height is below 1e-6 of their longest side
/// (float coordinates say nothing about them), and returns how many.
std::size_t drop_degenerate_triangles(Mesh& mesh);

/// Replaces the normals by the mean of the triangles' normals around each position, weighted by
/// the angle at the corner (Thürmer and Wüthrich 1998). Vertices at one and the same position count
/// as one, whether the triangles share them or not.
void smooth_normals(Mesh& mesh);

/// The axis-aligned box of all vertices that triangles use; low > high when there are none.
struct Bounds {
  Vec3d low{1e300, 1e300, 1e300};
  Vec3d high{-1e300, -1e300, -1e300};
};
Bounds bounds_of(std::span<const Mesh> meshes);

}  // namespace rimlight
