#pragma once

#include <memory>

#include "core/light/cube_light.h"
#include "core/light/environment.h"
#include "core/relight/background.h"

namespace rimlight {

/// What frames need of an environment, projected once: a second or so for both maps.
struct PreparedEnvironment {
  CubeLight texels;          // at the bake's size, unrotated
  BackgroundMap background;  // finer: what stands behind the pixels
};

/// Texels a side of the two.
struct PreparedSizes {
  int light = 0;
  int background = 0;
};

/// The environment's maps: made by the first who asks, then shared by all in the
/// process for as long as the environment lives. Any thread.
std::shared_ptr<const PreparedEnvironment> prepare_environment(
    const std::shared_ptr<const Environment>& environment, const PreparedSizes& sizes);

}  // namespace rimlight
