#pragma once

#include <cstddef>

#include "core/bake/tile_store.h"
#include "core/scene/scene.h"
#include "core/transport/bake_folder.h"

namespace rimlight {

/// Writes the finished tiles, pruned at `threshold`, as the bake's transport, and the coverage of
/// its pixels. Streams tile by tile: one tile's transport is in memory at a time. Returns the
/// number of blocks stored.
std::size_t write_transport(BakeWriter& writer, const TileStore& store, const PixelLayout& pixels,
                            float threshold);

/// Adds the scene's environments, each with the exposure that takes the mean of the bake under it,
/// unrotated, to 0.18.
void write_environments(BakeWriter& writer, const TileStore& store, const Scene& scene,
                        float threshold);

}  // namespace rimlight
