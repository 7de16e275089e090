#include "core/relight/design_state.h"

#include <cmath>

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

}  // namespace rimlight
