#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/material/measured_brdf.h"

namespace rimlight {

/// A Cornell `.brdf`: text; '#' begins a comment that ends with the line. Numbers between white
/// space: how many wavelengths, the wavelengths (nm, rising), then any number of samples
///     θ_i φ_i θ_s φ_s and a BRDF value for each wavelength
/// in radians. Spectra become linear RGB under daylight (spectrum.h); what is negative, as
/// measurement noise or a colour outside of RGB, becomes 0.
///
/// Between the scattered samples: the mean of the eight nearest, weighted by the inverse square of
/// their distance (Shepard 1968), of logarithms, for values lie orders of magnitude apart; at a
/// sample, its own value. Distances are between the points
///     (1.5 √(2θ_h/π), sin θ_d cos φ, sin θ_d sin φ),   φ = φ_d folded into [0, π/2],
/// so that reciprocal and mirrored pairs, which an isotropic surface cannot tell, are one. Farther
/// than kReach from the nearest sample there is none.
class CornellBrdf : public MeasuredBrdf {
 public:
  static constexpr double kReach = 0.25;

  /// Throws Error with `source`, and the line, at whatever is not a file as described.
  CornellBrdf(std::string_view text, const std::string& source);

  std::size_t sample_count() const { return points_.size(); }

 private:
  std::optional<Vec3d> value(const HalfDifference& angles,
                             const DirectionPair& pair) const override;

  std::vector<Vec3d> points_;
  std::vector<Vec3d> logarithms_;  // of value + kFloor, beside each point
};

}  // namespace rimlight
