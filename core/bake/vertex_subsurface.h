#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "core/bake/diffusion_dipole.h"
#include "core/scene/scene.h"
#include "core/transport/vertex_transport.h"

namespace rimlight {

/// What translucent surfaces do with irradiance E: at a vertex x of a material with a medium
///
///     E′(x) = Σ_y R(|x − y|) area_y E(y) / ∫ R
///
/// over the vertices y of the same material, with the dipole R of a channel. So a flat, evenly lit
/// surface keeps its irradiance, and its albedo holds ∫ R (vertex_material.h). The vertex' own area
/// counts as a disc, exactly. Vertices far away, against the size of their batch, count as one. A
/// sum of weights above 1 (where surfaces are closer to each other than a plane's) is scaled to 1:
/// no more light leaves than came. Other vertices keep E. Light that spreads less far than the mesh
/// has edges is not resolved.
class SubsurfaceSpread {
 public:
  SubsurfaceSpread(const VertexMesh& mesh, std::span<const Material> materials);

  /// Whether any vertex has a medium.
  bool is_needed() const { return needed_; }
  /// Whether the channels differ.
  bool is_coloured() const;
  /// values[vertex][coefficients] of one channel, in place. Uses all threads; the bytes do not
  /// depend on them.
  void apply(int channel, std::size_t coefficients, std::vector<float>& values) const;

 private:
  /// Vertices of one batch and one material.
  struct Cluster {
    std::uint32_t material = 0;
    std::vector<std::uint32_t> vertices;
    Vec3d middle;  // by area
    double radius = 0;
    double area = 0;
  };
  struct Medium {
    std::array<DiffusionDipole, 3> dipole;
    std::array<double, 3> reach;
  };

  void spread_vertex(int channel, std::size_t vertex, std::size_t coefficients,
                     std::span<const float> from, std::span<const float> means,
                     std::span<float> to) const;

  const VertexMesh& mesh_;
  std::vector<double> areas_;
  std::vector<std::optional<Medium>> media_;  // [material]
  std::vector<Cluster> clusters_;
  bool needed_ = false;
};

}  // namespace rimlight
