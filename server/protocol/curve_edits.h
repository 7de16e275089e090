#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "core/base/json_reader.h"
#include "core/relight/design_state.h"

namespace rimlight::server {

// Drawn factors of BRDFs, as they stand in edits and states:
//   {"scale": "linear" or "logarithmic", "points": [[position, r, g, b], …]}, or
//   {"values": [[r, g, b] × 256]}, or null to take the drawn one back

/// "half_angle", "difference_angle": the names of the axes in messages.
std::string_view axis_name(CurveAxis axis);

/// Null is a CurveEdit of neither points nor values. Throws Error, naming the field, for numbers
/// that are not finite, and as check_curve_points() and check_curve_values() do.
CurveEdit read_curve(const JsonReader& reader);
nlohmann::json curve_to_json(const CurveEdit& curve);

}  // namespace rimlight::server
