#pragma once

#include <cstddef>
#include <memory>

#include "core/scene/ray_scene.h"
#include "core/scene/scene.h"
#include "core/transport/vertex_transport.h"

namespace rimlight {

inline constexpr std::size_t kMostAddedVertices = std::size_t{1} << 21;

/// A scene's meshes as one, ready to be baked.
struct PreparedVertices {
  VertexMesh mesh;
  std::vector<VertexMaterial> materials;  // as the scene's, in their order
  std::size_t highlight_count = 0;        // the first so many vertices have a highlight
  // What was done to the scene's meshes.
  std::size_t computed_normals = 0;   // vertices that came without one
  std::size_t unused_vertices = 0;    // no triangle has them; dropped
  std::size_t joined_vertices = 0;    // equal to another in everything; dropped
  std::size_t dropped_triangles = 0;  // without area
  std::size_t added_vertices = 0;     // by refinement, before equal ones were joined
};

/// Joins a scene's meshes: triangles without area and vertices of no triangle are dropped, equal
/// vertices joined (never of different materials), and missing normals computed as means over the
/// triangles around (smooth_normals). Edges longer than the share `scene.bake.vertex.longest_edge`
/// of the longest side of the scene's box are split (mesh_refinement.h). Textures are looked up at
/// the vertices. Those with a highlight come first, and each part goes along a Morton curve, so
/// that batches are compact. Triangles follow the order of their vertices. Error when nothing is
/// left, or when refinement takes more than kMostAddedVertices.
PreparedVertices prepare_vertices(const Scene& scene);

/// The mesh for rays: its triangles are those of `mesh`, by index, of mesh 0.
RayScene ray_scene_of(const VertexMesh& mesh);

/// A third of the area of the triangles around each vertex.
std::vector<double> vertex_areas(const VertexMesh& mesh);

}  // namespace rimlight
