#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/transport/tile_transport.h"

namespace rimlight::test {

/// What a random sparse transport looks like.
struct RandomTransport {
  std::size_t tile_count = 1;
  std::size_t column_count = 24;
  double density = 0.05;  // share of blocks that are not zero
  double lowest = -1;     // of values before their block's size: −1 for both signs, 0 for one
  double empty_columns = 0.2;  // share of columns without any block in a tile
  std::uint64_t seed = 1;
};

/// Made through TileBuilder with a step of 2⁻²⁴, nothing left out: values over six decades, so that
/// every width is met. Some columns have no block, some all; chroma is rarer than luma.
std::vector<TileTransport> random_tiles(const RandomTransport& settings);
Transport random_transport(const RandomTransport& settings);

}  // namespace rimlight::test
