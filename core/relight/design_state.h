#pragma once

#include <map>
#include <optional>
#include <string>

#include "core/math/camera.h"
#include "core/math/rotation.h"

namespace rimlight {

/// What a session sets of one material; the rest stays as it was baked.
struct MaterialEdit {
  std::optional<Vec3f> albedo;     // linear RGB, 0 … 1
  std::optional<Vec3f> highlight;  // linear RGB, 0 … 1: the weight of the lobe
  std::optional<double> exponent;  // of the lobe

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

/// The state's rotation, exactly unit. Throws Error for a rotation that is no unit quaternion to
/// 10⁻³, or an exposure that is not within ±kMostStops.
Quaternion checked_rotation(const DesignState& state);

}  // namespace rimlight
