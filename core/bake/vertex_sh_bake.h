#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "core/bake/transport_bake.h"
#include "core/bake/vertex_mesh.h"
#include "core/bake/vertex_packing.h"
#include "core/scene/scene.h"

namespace rimlight {

/// What a bake of vertices found and did.
struct VertexBakeSummary {
  double seconds = 0;
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::size_t highlight_vertices = 0;
  std::size_t computed_normals = 0;
  std::size_t unused_vertices = 0;
  std::size_t dropped_triangles = 0;
  int irradiance_degree = 0;
  int visibility_degree = 0;
  std::size_t irradiance_channels = 1;
  std::size_t rays = 0;
  std::size_t capped_vertices = 0;  // whose error stayed above the one asked for
  double worst_error = 0;           // of a vertex, estimated
  std::size_t bytes = 0;            // of transport
};

/// Transport of prepared vertices, by the scene's settings, and what was measured on the way.
struct CalculatedVertices {
  CalculatedTransport transport;
  nlohmann::json measured;
  std::size_t rays = 0;
  std::size_t capped_vertices = 0;
  double worst_error = 0;
};
CalculatedVertices calculate_vertices(const Scene& scene, const PreparedVertices& prepared,
                                      const std::function<void(const BakeProgress&)>& progress);

/// Bakes a scene's vertices in spherical harmonics to `folder` (NAME.bake), as `scene->bake` asks
/// for. Uses all cores; the bytes do not depend on how many. An interrupted bake starts over.
/// Throws Error when the scene has no surface, is too large (2³² coefficients), asks for a degree
/// out of range, or when the folder cannot be written.
VertexBakeSummary bake_vertices(const std::shared_ptr<const Scene>& scene,
                                const std::filesystem::path& folder,
                                const std::function<void(const BakeProgress&)>& progress);

}  // namespace rimlight
