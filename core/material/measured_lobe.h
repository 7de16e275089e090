#pragma once

#include <array>

#include "core/material/factorization.h"
#include "core/math/sampling.h"
#include "core/math/vec.h"

namespace rimlight {

/// A measured BRDF in factors, as surfaces of BrdfModel::measured reflect: the product of its
/// factors, and half vectors drawn from the one over θ_h. Directions as in brdf.h. Immutable; any
/// thread.
///
/// A bin of θ_h is drawn with probability ∝ mean(H) ∫ cos θ_h dω_h, and the half vector in it with
/// density ∝ cos θ_h; the density of ω_i is that over 4 cos θ_d (Walter and others 2007, equation
/// 14). The other factors are not in it. Where H is zero everywhere, as if it were constant.
class MeasuredLobe {
 public:
  explicit MeasuredLobe(FactoredBrdf factors);

  const FactoredBrdf& factors() const { return factors_; }
  /// Above the horizon; in double inside.
  Vec3f evaluate(const Vec3f& in, const Vec3f& out) const;
  /// The density with which draw() gives `in`; all directions together at most 1.
  float density(const Vec3f& in, const Vec3f& out) const;
  /// May be below the horizon.
  Vec3f draw(const Vec3f& out, const Sample2& at) const;
  /// Beckmann's m of the distribution of half vectors that has the same median.
  float roughness() const;

 private:
  FactoredBrdf factors_;
  std::array<double, kCurveBins + 1> cumulative_{};    // probability of the bins before
  std::array<double, kCurveBins + 1> sine_squared_{};  // of where they begin
};

}  // namespace rimlight
