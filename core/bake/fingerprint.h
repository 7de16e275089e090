#pragma once

#include <cstdint>

#include "core/scene/scene.h"

namespace rimlight {

/// A hash of everything that a bake of the scene depends on: geometry, materials, camera, settings
/// and the version of the bake itself. Parts of an unfinished bake are kept only while it stays the
/// same.
std::uint64_t fingerprint(const Scene& scene);

}  // namespace rimlight
