#pragma once

#include <string>
#include <vector>

#include "core/basis/cube_haar.h"
#include "core/light/cube_light.h"

namespace rimlight {

/// A light under which a bake's compression is held to the error asked for.
struct CheckLight {
  std::string name;
  CubeLight coefficients;  // Haar
};

/// The fixed set: "sunny", "cathedral" and a single lit texel, each as it is and under three random
/// rotations, the same for every scene of a cube size.
std::vector<CheckLight> make_check_lights(const CubeHaar& haar);

/// The Haar coefficients of a light's texels, channel by channel.
CubeLight to_coefficients(const CubeHaar& haar, CubeLight texels);

}  // namespace rimlight
