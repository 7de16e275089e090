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
  /// The light in the set that this one is a rotation of (itself, if none).
  std::size_t unrotated = 0;
};

/// Images of covered receivers: [light][receiver].
using LightImages = std::vector<std::vector<Vec3f>>;

/// The exposure at which each light's image is judged: its own (auto_exposure_scale), but never
/// more than that of its unrotated light, which is what a session shows. Else a light that a
/// rotation puts below the floor, where it reaches next to nothing, would be judged on magnified
/// rounding errors.
std::vector<double> check_exposures(const std::vector<CheckLight>& lights,
                                    const LightImages& references);

/// The fixed set: "sunny", "cathedral" and a single lit texel, each as it is and under three random
/// rotations, the same for every scene of a cube size.
std::vector<CheckLight> make_check_lights(const CubeHaar& haar);

/// Their coefficients alone.
std::vector<CubeLight> coefficients_of(const std::vector<CheckLight>& lights);

/// The Haar coefficients of a light's texels, channel by channel.
CubeLight to_coefficients(const CubeHaar& haar, CubeLight texels);

}  // namespace rimlight
