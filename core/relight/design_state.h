#pragma once

#include <string>

#include "core/math/rotation.h"

namespace rimlight {

/// What a design session shows: absolute, so that a late edit replaces an early one.
struct DesignState {
  std::string environment;    // a name of the bake's environments
  Quaternion rotation;        // of the light, unit
  double exposure_stops = 0;  // 0 shows the bake as its manifest's exposure does

  friend bool operator==(const DesignState&, const DesignState&) = default;
};

}  // namespace rimlight
