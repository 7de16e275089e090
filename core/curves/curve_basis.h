#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/basis/daubechies_interval.h"
#include "core/material/brdf_curve.h"

namespace rimlight {

/// A curve's coefficients, in DaubechiesInterval's order.
using CurveCoefficients = std::array<Vec3f, kCurveBins>;

/// The coordinates of curves: DaubechiesInterval(256) over the bins, each weighted so that the
/// basis is orthonormal as functions of the half vector (over the sphere) or of θ_d,
///     Σ_bin T′_bin c_bin = Σ_k T̂_k ĉ_k,   ĉ = W(g c),   T̂ = W(T′ / g),
///     g² ∝ the bin's solid angle for θ_h (bins below the eighth as that one), 1 for θ_d.
/// The bins of θ_h hold from 2e-9 to 0.01 sr. Without the weights, T̂ of the widest bins would have
/// to cancel to nine digits where a lobe is narrow. Immutable; any thread.
class CurveBasis {
 public:
  explicit CurveBasis(CurveAxis axis);

  CurveAxis axis() const { return axis_; }
  CurveCoefficients coefficients(const BrdfCurve& curve) const;
  /// The inverse.
  BrdfCurve curve(const CurveCoefficients& coefficients) const;

  /// T′ of `lanes` receivers to T̂: [256][lanes] each; `bins` is overwritten.
  void transform(std::span<float> bins, std::span<float> coefficients, std::size_t lanes) const;

 private:
  CurveAxis axis_;
  DaubechiesInterval wavelets_;
  std::array<double, kCurveBins> weight_{};
};

}  // namespace rimlight
