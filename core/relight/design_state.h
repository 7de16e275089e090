#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/math/camera.h"
#include "core/math/rotation.h"

namespace rimlight {

/// What a session sets of one material; the rest stays as it was baked.
struct MaterialEdit {
  std::optional<Vec3f> albedo;     // linear RGB, 0 … 1
  std::optional<Vec3f> highlight;  // linear RGB, 0 … 1: the weight of the lobe
  std::optional<double> exponent;  // of the lobe
  /// Takes the exponent's place: the lobe's values over the angle from the mirror direction, evenly
  /// spaced from 0° to 90°, linear in between, whatever their scale (check_lobe).
  std::optional<std::vector<double>> lobe = {};

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
