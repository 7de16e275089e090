#pragma once

#include <string>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/light/environment.h"
#include "core/scene/scene.h"
#include "core/transport/vertex_transport.h"
#include "core/vertices/vertex_products.h"

namespace rimlight {

/// What a report was asked to measure on, before anything is calculated.
struct NamedMesh {
  std::string name;
  std::vector<Mesh> meshes;
};

/// A mesh by itself under the sky, with direct transport to one degree: for reports, which need no
/// bake of a scene. Owns its memory.
struct LitMesh {
  std::string name;
  VertexMesh mesh;
  int degree = 0;
  AlignedVector<Half> irradiance, visibility;

  VertexTransportView view() const;
  /// A copy with the bands to `lower` ≤ degree only.
  LitMesh to_degree(int lower) const;
};

/// Which directions a vertex' transport is summed over: the same even ones on the sphere for all,
/// so that neighbours differ by what they see only.
inline constexpr std::size_t kSkyDirections = 1024;

/// Joins meshes to one (materials aside), drops vertices that no triangle uses, computes normals
/// where a mesh has none, and traces one shadow ray from each vertex to each direction above its
/// surface. `degree` to sh::kLargestDegree. Throws Error (naming `name`) when no triangle is left.
LitMesh light_mesh(std::string name, std::vector<Mesh> meshes, int degree);

/// Coefficients of a light, [3][(degree + 1)²], from its texels on a cube map.
std::vector<float> light_coefficients(const Environment& environment, int degree);

/// What an eye sees of a mesh: vertices that face it with nothing between, rising; and where each
/// vertex of the mesh mirrors the eye to.
struct MeshView {
  std::vector<std::uint32_t> visible;
  std::vector<Vec3f> mirrored;  // [vertex]
};
MeshView view_mesh(const LitMesh& lit, const Vec3d& eye_direction);

}  // namespace rimlight
