#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/material/brdf_curve.h"
#include "core/material/factorization.h"
#include "core/relight/design_state.h"
#include "core/transport/curve_receivers.h"

namespace rimlight {

/// Measured BRDFs that a session may put in the place of a model, by name.
using MeasuredLibrary = std::map<std::string, FactoredBrdf, std::less<>>;

/// A material as a session shows it: a model with its parameters, or a measured BRDF in factors,
/// and the curves in the place of its editable factors. Both curves are bins always, the model's
/// own as bin averages, so that T′ of either axis gives the same image.
struct CurveMaterialState {
  Brdf brdf;
  std::optional<FactoredBrdf> measured = {};  // in the place of `brdf`
  // Nothing where it has no such factor.
  std::optional<BrdfCurve> half_angle = {}, difference_angle = {};

  bool has(CurveAxis axis) const { return curve(axis).has_value(); }
  const std::optional<BrdfCurve>& curve(CurveAxis axis) const {
    return axis == CurveAxis::half_angle ? half_angle : difference_angle;
  }
};

/// The baked material with a session's edit. Throws Error naming `where` and the field for a
/// parameter outside brdf.h's domain, a curve that check_curve_points or check_curve_values
/// refuses, or a measured BRDF that the library does not have. What the model does not have is left
/// out.
CurveMaterialState resolve(const CurveMaterial& baked, const MaterialEdit& edit,
                           const MeasuredLibrary& library, const std::string& where);

/// What an edit asks that the model does not have, a sentence each: "phong has no curve over θ_h".
std::vector<std::string> unavailable(const CurveMaterial& baked, const MaterialEdit& edit);

/// What must be made again when one state follows another.
struct CurveStateChange {
  bool transport_half_angle = false, transport_difference_angle = false;  // T′
  bool half_angle = false, difference_angle = false;  // the curve that multiplies it
  bool fixed = false;                                 // what has no editable factor

  bool transport(CurveAxis axis) const {
    return axis == CurveAxis::half_angle ? transport_half_angle : transport_difference_angle;
  }
  bool any() const {
    return transport_half_angle || transport_difference_angle || half_angle || difference_angle ||
           fixed;
  }
};
CurveStateChange change(const CurveMaterialState& from, const CurveMaterialState& to);

}  // namespace rimlight
