#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/material/measured_brdf.h"
#include "core/material/rgl_grid.h"
#include "core/material/rgl_tensor_file.h"

namespace rimlight {

/// An isotropic RGB material of the RGL database (`…_rgb.bsdf`; Dupuy and Jakob 2018, "An adaptive
/// parameterization for efficient material acquisition and rendering"). With the polar angle θ_i of
/// ω_i, the half vector's θ_h and its azimuth against ω_i's, and the maps u(θ) = √(2θ/π) and
/// u(φ) = φ/2π:
///     f = R(V⁻¹(u_h)) · N(u_h) / (4 σ(u_i) cos θ_o)
/// N is the measured distribution of half vectors (`ndf`), σ its projected area (`sigma`), V⁻¹
/// takes half vectors to the uniform square by the distribution of visible ones (`vndf`), and R
/// (`rgb`) is what was measured there; all bilinear, and linear between the angles of `theta_i`.
/// Negative values (measurement noise) become 0. f is reciprocal only as far as the measurement
/// was. There is no sample where N or σ vanish.
class RglBrdf : public MeasuredBrdf {
 public:
  /// Throws Error when the file is malformed, anisotropic or spectral.
  RglBrdf(std::span<const std::byte> bytes, const std::string& source)
      : RglBrdf(RglTensorFile(bytes, source)) {}

 private:
  explicit RglBrdf(const RglTensorFile& file);
  std::optional<Vec3d> value(const HalfDifference& angles,
                             const DirectionPair& pair) const override;

  RglWarp::Place place(double theta) const;

  std::vector<float> theta_;  // rising
  RglGrid sigma_, ndf_;
  RglWarp visible_;               // [θ_i]
  std::vector<RglGrid> colours_;  // [θ_i][channel]
};

}  // namespace rimlight
