#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/transport/receivers.h"
#include "core/transport/tile_transport.h"

namespace rimlight::stability {

/// Tiles of random transport: `density` of its blocks hold values of both signs over six decades,
/// rounded to 2⁻²⁴, nothing left out.
struct RandomTiles {
  std::size_t tiles = 1;
  std::size_t columns = 96;
  double density = 0.5;
  std::uint64_t seed = 1;
};
std::vector<TileTransport> make_tiles(const RandomTiles& settings);

/// Reflectance 1 everywhere.
ReceiverValues white(std::size_t tiles);

}  // namespace rimlight::stability
