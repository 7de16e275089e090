#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>

#include "core/material/brdf.h"

namespace rimlight {

/// What an editable factor of a BRDF depends on.
enum class CurveAxis { half_angle, difference_angle };

/// A factor of a BRDF over one angle, constant in each of 256 bins, linear RGB.
///   half_angle        over θ_h; bin i begins at (i / 256)² · π/2, as in the MERL files: narrow
///                     where lobes are
///   difference_angle  over θ_d; bin i begins at (i / 256) · π/2
inline constexpr std::size_t kCurveBins = 256;
using CurveValues = std::array<Vec3f, kCurveBins>;
struct BrdfCurve {
  CurveAxis axis = CurveAxis::half_angle;
  CurveValues values{};

  friend bool operator==(const BrdfCurve&, const BrdfCurve&) = default;
};

/// Where bin `bin` begins, in radians; bin kCurveBins begins at π/2.
double bin_begin(CurveAxis axis, double bin);
/// The bin that holds an angle of [0, π/2]; angles beyond go to the first or last one.
std::size_t bin_of(CurveAxis axis, double angle);

/// A factor's average in each bin: over solid angle (sin θ dθ) for θ_h, so that a smooth lobe keeps
/// its energy, over the angle for θ_d. Gauss–Legendre with 8 points a bin.
BrdfCurve bin_averages(CurveAxis axis, const std::function<Vec3d(double angle)>& factor);

/// An analytic model's own factor over θ_h or θ_d at one angle; nothing for models without one.
///   blinn_phong        θ_h: C(n) cos^n θ_h
///   cook_torrance      θ_h: D(θ_h);  θ_d: the Fresnel reflectance
///   ashikhmin_shirley  θ_d: Schlick's Fresnel reflectance
/// Phong's lobe is no function of θ_h. Of Ward's and Ashikhmin and Shirley's, which are
/// anisotropic, the parameters are edited instead.
std::optional<Vec3d> factor(const Brdf& brdf, CurveAxis axis, double angle);
/// The same as bin averages.
std::optional<BrdfCurve> factor_curve(const Brdf& brdf, CurveAxis axis);

/// Which of its factors a quotient BRDF lacks.
struct FactorSet {
  bool half_angle = false;
  bool difference_angle = false;
};

/// The quotient BRDF (Ben-Artzi, Overbeck and Ramamoorthi 2006): the specular lobe with factors
/// left out, so that
///     evaluate_specular(brdf, in, out) = quotient(brdf, {true}, in, out) · factor(θ_h)
/// and so on. Never divided out, but left out of the product: finite where a factor vanishes, and
/// not zero there. The factors must be there (CheckFailure). In double; zero below the horizon.
Vec3d quotient(const Brdf& brdf, FactorSet without, const Vec3d& in, const Vec3d& out);

/// A material whose factors are drawn: the curve takes its factor's place.
struct CurvedBrdf {
  Brdf base;
  std::optional<BrdfCurve> half_angle, difference_angle;
};

/// The whole BRDF with its curves, the diffuse part of `base` as it is: what an edited image shows.
Vec3d evaluate(const CurvedBrdf& brdf, const Vec3d& in, const Vec3d& out);

}  // namespace rimlight
