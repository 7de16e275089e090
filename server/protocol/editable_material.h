#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "core/transport/curve_receivers.h"

namespace rimlight::server {

/// A measured BRDF of a bake, in factors, that editable materials may load.
struct MeasuredChoice {
  std::string name;
  FactoredBrdf brdf;
};

/// The factors of the material as it was baked that can be drawn.
std::vector<CurveAxis> curve_axes(const CurveMaterial& material);

/// As it stands in the welcome: {"name", "model", "albedo", …, "axes"}. The model of a measured one
/// is "measured".
nlohmann::json editable_to_json(const CurveMaterial& material);

/// {"half_angle": [[r, g, b] × 256] or null, "difference_angle", "rest", "fit_error"}: the factors
/// as they were baked, in bins; `rest` and `fit_error` of measured ones, else null.
nlohmann::json curves_to_json(const CurveMaterial& material);
nlohmann::json curves_to_json(const FactoredBrdf& brdf);

}  // namespace rimlight::server
