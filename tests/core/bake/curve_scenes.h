#pragma once

#include <cstdint>
#include <memory>

#include "core/scene/scene.h"

namespace rimlight::test {

/// Its materials.
inline constexpr std::uint32_t kPearl = 0, kFloor = 1, kGold = 2, kCloth = 3;

/// A textured ball of pearl over a floor, between a box of gold and one of measured cloth, which
/// shade both. One tile of 32 × 32 pixels, cube size 8, no bounces.
std::shared_ptr<Scene> curve_scene();

}  // namespace rimlight::test
