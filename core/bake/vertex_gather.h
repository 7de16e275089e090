#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/bake/ray_rounds.h"
#include "core/bake/vertex_visibility.h"
#include "core/scene/ray_scene.h"
#include "core/transport/vertex_transport.h"

namespace rimlight {

/// What vertices see of each other: of the light that arrives at a vertex under even radiance,
/// weight is the part that comes from the surface around another. A sparse matrix by rows, columns
/// ascending; a row sums up to at most 1, by as much less as the vertex sees of the sky (and of
/// surfaces' backs, which are black).
struct GatherMatrix {
  std::vector<std::uint64_t> first;  // [vertices + 1]
  std::vector<std::uint32_t> column;
  std::vector<float> weight;

  std::size_t rows() const { return first.size() - 1; }
  double row_sum(std::size_t row) const;
};

struct Gathered {
  GatherMatrix matrix;
  std::size_t rays = 0;
  std::size_t capped_vertices = 0;  // whose error stayed above the one asked for
  double worst_error = 0;           // of a vertex' indirect light, first bounce
  double rms_error = 0;             // over all vertices
};

/// Rays by the cosine from every vertex that is not open to the whole sky (blocked[vertex] > 0), in
/// rounds (ray_rounds.h) until the indirect light's error is below the one asked for, or the cap is
/// reached: as estimated from the first bounce.
///   albedo      [vertex]: the largest channel of what a vertex reflects
///   irradiance  [vertex][(n + 1)²]: direct
/// A surface shines on the side of its vertices' normals. The bytes do not depend on threads.
Gathered gather(const RayScene& scene, const VertexMesh& mesh,
                std::span<const std::uint32_t> blocked, std::span<const float> albedo,
                std::span<const float> irradiance, const RaySettings& settings,
                const ShareDone& done);

}  // namespace rimlight
