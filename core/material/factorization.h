#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "core/material/brdf_curve.h"
#include "core/material/measured_brdf.h"

namespace rimlight {

/// Knots of a factor's rest over a direction's own polar angle, evenly from 0 to π/2.
inline constexpr std::size_t kRestKnots = 65;

/// How far a factorization is from what it stands for, per channel, over samples that are spread
/// over all angles.
struct FitError {
  /// The root mean square of the difference of logarithms, weighted as the fit is: what it makes
  /// smallest. 0.1 is a typical error of 10 %.
  Vec3d logarithmic;
  /// The root of Σ (f − fit)² over Σ f², weighted by the light that goes each way
  /// (cos θ_i cos θ_o dω_i dω_o).
  Vec3d relative;
};

/// A measured BRDF as a product of factors that can be edited:
///     f ≈ H(θ_h) · Δ(θ_d) · P(θ_i) · P(θ_o)
/// (homomorphic factorization: McCool, Ang and Ahmad 2001, with these projections as their
/// factors). Each is RGB and positive. The geometric means of Δ and P over the samples are 1, so H
/// has the scale.
struct FactoredBrdf {
  BrdfCurve half_angle{CurveAxis::half_angle, {}};
  BrdfCurve difference_angle{CurveAxis::difference_angle, {}};
  std::array<Vec3f, kRestKnots> rest{};  // P, linear in its logarithm between knots
  FitError error;                        // of the curves as they were fitted
  double valid_share = 0;                // of the angles that were asked for, those with a sample
  double condition = 0;  // of the equations of the fit, estimated; 0 where it was not fitted here
};

/// P(θ_i) P(θ_o): the quotient BRDF that stays when curves are edited. Zero below the horizon.
Vec3d rest_at(const FactoredBrdf& brdf, const Vec3d& in, const Vec3d& out);
/// The product of all factors.
Vec3d evaluate(const FactoredBrdf& brdf, const Vec3d& in, const Vec3d& out);

/// Least squares in log space over 256 × 48 × 16 angles (θ_h, θ_d, φ_d), each weighted by
/// cos θ_i cos θ_o; values below 1e-4 count as 1e-4. Bins without a sample follow their neighbours
/// smoothly. About 0.2 M evaluations and one dense solve of 577 unknowns. Throws Error naming
/// `source` when there is no sample at all.
FactoredBrdf factorize(const MeasuredBrdf& brdf, const std::string& source);

}  // namespace rimlight
