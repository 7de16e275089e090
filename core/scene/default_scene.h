#pragma once

#include <cstdint>

#include "core/scene/scene.h"

namespace rimlight {

/// The scene that anyone sees first, made by code from a seed: a terrace under a slatted pergola, a
/// glossy vase, a plant with thousands of leaves, a metal ring with its caustic, coloured walls
/// that bleed. A scene source says it with { "builtin": "terrace" } among its objects.
Scene default_scene(std::uint64_t seed = 1);

}  // namespace rimlight
