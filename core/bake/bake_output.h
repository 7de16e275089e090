#pragma once

#include <cstddef>

#include "core/bake/tile_store.h"
#include "core/transport/bake_folder.h"

namespace rimlight {

/// Writes the finished tiles, pruned at `least_energy`, as the bake's transport, and the coverage
/// and reflectance of its pixels. A few tiles are in memory at a time. Returns the bytes of
/// transport stored.
std::size_t write_transport(BakeWriter& writer, const TileStore& store, const PixelLayout& pixels,
                            float least_energy);

}  // namespace rimlight
