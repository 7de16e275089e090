#include "core/relight/design_state.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/base/error.h"

namespace rimlight {
namespace {

constexpr double kUnitTolerance = 1e-3;  // a client's quaternion comes through decimal digits

}  // namespace

Quaternion checked_rotation(const DesignState& state) {
  if (!(std::abs(state.exposure_stops) <= kMostStops)) {
    throw Error("exposure_stops", std::to_string(state.exposure_stops),
                "at most " + std::to_string(kMostStops) + " either way");
  }
  const double size = norm(state.rotation);
  if (!(std::abs(size - 1) <= kUnitTolerance)) {
    throw Error("rotation", "a quaternion of length " + std::to_string(size), "a unit quaternion");
  }
  return normalized(state.rotation);
}

BrdfCurve curve_of(CurveAxis axis, const CurveEdit& edit) {
  if (!edit.points.empty()) return curve_from_points(axis, edit.scale, edit.points, "points");
  BrdfCurve curve{axis, {}};
  RIMLIGHT_CHECK_EQ(edit.values.size(), kCurveBins);
  std::ranges::copy(edit.values, curve.values.begin());
  return curve;
}

void check_lobe(std::span<const double> values, const std::string& where) {
  if (values.size() < kFewestLobeValues || values.size() > kMostLobeValues) {
    throw Error(where, std::to_string(values.size()) + " values", "2 to 64");
  }
  bool is_black = true;
  for (const double value : values) {
    if (!(value >= 0 && value <= kLargestLobeValue)) {
      throw Error(where, std::to_string(value), "values of 0 to 1000000");
    }
    is_black &= value == 0;
  }
  if (is_black) throw Error(where, "nothing but zeros", "a value above 0");
}

}  // namespace rimlight
