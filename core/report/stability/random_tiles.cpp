#include "core/report/stability/random_tiles.h"

#include <cmath>

#include "core/base/parallel.h"
#include "core/math/random.h"
#include "core/transport/receiver_planes.h"
#include "core/transport/tile_builder.h"

namespace rimlight::stability {
namespace {

/// A group's planes; chroma is rarer and smaller, as it is in bakes.
std::vector<float> random_planes(const RandomTiles& settings, std::uint64_t group) {
  std::vector<float> planes(settings.columns * kGroupFloats);
  Random random(settings.seed, group);
  for (std::size_t at = 0; at < planes.size(); at += kBlockReceivers) {
    const bool chroma = at % kGroupFloats >= PixelLayout::kGroupReceivers;
    if (random.uniform() >= settings.density * (chroma ? 0.25 : 1)) continue;
    const double size = std::pow(10.0, random.uniform(-6, chroma ? -1 : 0));
    for (std::size_t i = 0; i < kBlockReceivers; ++i) {
      planes[at + i] = static_cast<float>(size * random.uniform(-1, 1));
    }
  }
  return planes;
}

}  // namespace

std::vector<TileTransport> make_tiles(const RandomTiles& settings) {
  std::vector<TileTransport> tiles(settings.tiles);
  parallel_for(settings.tiles, [&](std::size_t tile) {
    TileBuilder builder(settings.columns, {0x1p-24f, 0});
    for (std::size_t group = 0; group < TileBuilder::kGroups; ++group) {
      builder.add_group(group, random_planes(settings, tile * TileBuilder::kGroups + group));
    }
    tiles[tile] = builder.assemble();
  });
  return tiles;
}

ReceiverValues white(std::size_t tiles) {
  ReceiverValues values(tiles);
  for (std::size_t i = 0; i < tiles * kTileReceivers; ++i) values.set(i, {1, 1, 1});
  return values;
}

}  // namespace rimlight::stability
