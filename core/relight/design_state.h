#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/material/curve_points.h"
#include "core/math/camera.h"
#include "core/math/rotation.h"

namespace rimlight {

/// A factor of a BRDF as a session drew it: points to draw a curve through, or its values in all
/// bins. Exactly one of the two is not empty.
struct CurveEdit {
  CurveScale scale = CurveScale::linear;  // of the curve between the points
  std::vector<CurvePoint> points;         // check_curve_points()
  std::vector<Vec3f> values;              // kCurveBins of them; check_curve_values()

  friend bool operator==(const CurveEdit&, const CurveEdit&) = default;
};

/// The curve's bins.
BrdfCurve curve_of(CurveAxis axis, const CurveEdit& edit);

/// What a session sets of one material; the rest stays as it was baked. A mode shows the fields
/// that it knows.
struct MaterialEdit {
  std::optional<Vec3f> albedo;     // linear RGB, 0 … 1
  std::optional<Vec3f> highlight;  // linear RGB, 0 … 1: the weight of the lobe
  std::optional<double> exponent;  // of the lobe
  /// Takes the exponent's place: the lobe's values over the angle from the mirror direction, evenly
  /// spaced from 0° to 90°, linear in between, whatever their scale (check_lobe).
  std::optional<std::vector<double>> lobe = {};

  // Of bakes of kind brdf_curve.
  std::optional<Vec3f> specular = {};     // 0 … 1: multiplies the lobe
  std::optional<double> roughness = {};   // 1e-4 … 1
  std::optional<Vec3f> eta = {}, k = {};  // 0.05 … 100, 0 … 100
  /// Along the tangent and across; one alone is the same in both.
  std::optional<double> exponent_across = {}, roughness_across = {};
  /// In the place of the model's own factor over θ_h or θ_d.
  std::optional<CurveEdit> half_angle = {}, difference_angle = {};
  /// A measured BRDF of the bake, by its name, in the place of the model.
  std::optional<std::string> measured = {};

  friend bool operator==(const MaterialEdit&, const MaterialEdit&) = default;
};

/// What a design session shows: absolute, so that a late edit replaces an early one.
struct DesignState {
  std::string environment;          // a name of the bake's environments
  Quaternion rotation;              // of the light, unit
  double exposure_stops = 0;        // 0 shows the bake as its manifest's exposure does
  std::optional<Camera> view = {};  // the bake's own camera without one
  std::map<std::string, MaterialEdit> materials = {};  // by name

  friend bool operator==(const DesignState&, const DesignState&) = default;
};

/// Stops that an exposure may be, either way.
inline constexpr double kMostStops = 64;

/// Values of a lobe, and how large each may be.
inline constexpr std::size_t kFewestLobeValues = 2, kMostLobeValues = 64;
inline constexpr double kLargestLobeValue = 1e6;

/// Throws Error for too few or too many values, one that is not within 0 … kLargestLobeValue, and
/// for nothing but zeros.
void check_lobe(std::span<const double> values, const std::string& where);

/// The state's rotation, exactly unit. Throws Error for a rotation that is no unit quaternion to
/// 10⁻³, or an exposure that is not within ±kMostStops.
Quaternion checked_rotation(const DesignState& state);

}  // namespace rimlight
