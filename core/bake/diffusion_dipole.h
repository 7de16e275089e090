#pragma once

#include "core/scene/scene.h"

namespace rimlight {

/// Diffuse reflectance of a half space by the dipole of Jensen, Marschner, Levoy and Hanrahan
/// (2001, A Practical Model for Subsurface Light Transport, section 2.1), in one channel: light
/// that enters at a point leaves at a distance r with
///
///     R(r) = α′/4π · ( z_r (1 + σ_tr d_r) e^(−σ_tr d_r) / d_r³ + z_v (1 + σ_tr d_v) e^(−σ_tr d_v)
///            / d_v³ ),     d² = r² + z²
///
/// with σ_t′ = σ_a + σ_s′, α′ = σ_s′/σ_t′, σ_tr = √(3 σ_a σ_t′), z_r = 1/σ_t′, z_v = z_r (1 +
/// 4A/3), A = (1 + F)/(1 − F), F = −1.440/η² + 0.710/η + 0.668 + 0.0636 η the diffuse Fresnel
/// reflectance.
class DiffusionDipole {
 public:
  DiffusionDipole(double absorption, double scattering, double eta);

  /// R(r), per area.
  double at(double distance) const;
  /// ∫ R over the disc of this radius: closed, since r dr = d dd.
  double within(double radius) const;
  /// The same over the plane: what a flat surface reflects of even light; below 1.
  double reflectance() const { return reflectance_; }
  /// A radius outside of which no more than `share` of the reflectance lies.
  double reach(double share) const;

 private:
  double integral_from(double depth, double radius) const;

  double albedo_;      // α′
  double falloff_;     // σ_tr
  double real_depth_;  // z_r
  double virtual_depth_;
  double reflectance_;
};

DiffusionDipole dipole_of(const Subsurface& medium, int channel);

}  // namespace rimlight
