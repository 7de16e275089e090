#pragma once

#include <span>
#include <vector>

#include "core/bake/group.h"
#include "core/import/direction_cells.h"
#include "core/light/cube_light.h"

namespace rimlight {

/// What one column of imported transport was made with. With T(ω) the transport of a pixel,
/// B = ∫ L(ω) T(ω) dω, and ω_j the column's direction:
///
///   irradiance  M_j = T(ω_j), per steradian: the pixel under a lamp at ω_j, so far away that its
///               light comes from one direction only, and so strong that a surface that faces it
///               has irradiance 1 (∫ L dω = 1). One-light-at-a-time pictures are of this kind. A
///               light of radiance L_j over the solid angle w_j gives w_j L_j M_j
///   radiance    M_j = ∫ T dω over the directions that the column stands for: the pixel under
///               radiance 1 from all of them and darkness elsewhere, as when the texels of an
///               environment are lit one by one. A light of radiance L_j there gives L_j M_j
enum class ColumnUnit { irradiance, radiance };

/// Carries transport over from directions to the texels of a cube map. A column's energy under
/// radiance 1, e_j M_j with e_j = w_j (irradiance) or 1 (radiance), is spread evenly over the
/// direction's cell, so a texel's transport (its integral, CubeHaar's convention) is
///
///     T_t = Σ_j |cell_j ∩ texel_t| / |cell_j| · e_j M_j
///
/// Shares of a cell sum to 1: under a uniform environment of radiance L a pixel has exactly
/// L · Σ_j e_j M_j, whatever the cube map.
class TransportResampler {
 public:
  /// `energy` [directions], ≥ 0. Cells without area are CheckFailure.
  TransportResampler(const DirectionCells& cells, std::span<const double> energy);

  std::size_t direction_count() const { return first_share_.size() - 1; }

  /// One group: rows [direction][3][64], 64-byte aligned, to texels (overwritten).
  void resample(std::span<const float> rows, GroupRows& texels) const;

  /// What resampled transport answers to a light of texels, said for the directions: B = Σ_j
  /// (result j) · M_j. e_j times the light's mean over the cell, each texel counted as uniform.
  std::vector<Vec3f> light_of_directions(const CubeLight& light) const;

 private:
  struct Share {
    std::uint32_t texel;
    float weight;
  };
  std::vector<std::size_t> first_share_;
  std::vector<Share> shares_;
};

}  // namespace rimlight
