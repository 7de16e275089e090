#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/bake/ray_rounds.h"
#include "core/scene/ray_scene.h"
#include "core/transport/vertex_transport.h"

namespace rimlight {

/// Transport of vertices straight from the sky, in spherical harmonics to one degree, [(n + 1)²] a
/// vertex.
struct VertexVisibility {
  std::vector<float> irradiance;  // [vertex][coefficients]: ∫ max(0, n·ω) V(ω) Y_i(ω) dω
  std::vector<float> visibility;  // [highlight vertex][coefficients]: ∫ over n·ω > 0 of V Y_i dω
  // What it took, [vertex]; empty when nothing was traced.
  std::vector<std::uint32_t> rays;     // of the last round
  std::vector<std::uint32_t> blocked;  // of these
  std::vector<float> error;            // estimated, of the worse of the two
  /// Root mean squares of a coefficient's error over vertices, by band, as replicates say.
  struct ByBand {
    std::vector<double> irradiance;                   // of vertices without a highlight
    std::vector<double> irradiance_beside_highlight;  // of those with one
    std::vector<double> visibility;                   // of those with one
  } rms_by_band;
};

/// Told, from any thread but one at a time, the share of the work that is done.
using ShareDone = std::function<void(double)>;

/// V = 1: clamped cosine and hemisphere about the normal, without error.
VertexVisibility unshadowed_visibility(const VertexMesh& mesh, std::size_t highlight_count,
                                       int degree);

/// V from `scene` (ray_scene_of the mesh), by rounds of rays (ray_rounds.h) until the error asked
/// for, or the cap, is reached: uniform over the hemisphere for vertices with a highlight, by the
/// cosine for the others. Only rays that are blocked count, subtracted from what is known without
/// shadows, so that a vertex that sees the whole sky is exact. The bytes do not depend on threads.
VertexVisibility shadowed_visibility(const RayScene& scene, const VertexMesh& mesh,
                                     std::size_t highlight_count, const RaySettings& settings,
                                     const ShareDone& done);

/// Where rays from a vertex start: off the surface by what the rounding of coordinates asks for.
Vec3f vertex_ray_origin(const VertexMesh& mesh, std::size_t vertex, float extent);

}  // namespace rimlight
