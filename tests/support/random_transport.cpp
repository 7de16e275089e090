#include "tests/support/random_transport.h"

#include <algorithm>
#include <cmath>

#include "core/math/random.h"
#include "core/transport/tile_builder.h"

namespace rimlight::test {
namespace {

/// The share of blocks that a column has in a tile: none, all, or the density asked for.
double column_density(const RandomTransport& settings, std::size_t tile, std::size_t column) {
  Random random(settings.seed, 1'000'000 + tile * settings.column_count + column);
  const double u = random.uniform();
  if (u < settings.empty_columns) return 0;
  return u > 0.98 ? 1 : settings.density;
}

std::vector<float> random_planes(const RandomTransport& settings, std::size_t tile,
                                 std::size_t group) {
  std::vector<float> planes(settings.column_count * kGroupFloats);
  Random random(settings.seed, tile * TileBuilder::kGroups + group);
  for (std::size_t column = 0; column < settings.column_count; ++column) {
    const double density = column_density(settings, tile, column);
    for (std::size_t at = 0; at < kGroupFloats; at += kBlockReceivers) {
      const bool chroma = at >= PixelLayout::kGroupReceivers;
      if (random.uniform() >= (chroma ? density / 4 : density)) continue;
      const double size = std::pow(10.0, random.uniform(-6, 0)) * (chroma ? 0.1 : 1);
      for (std::size_t i = 0; i < kBlockReceivers; ++i) {
        planes[column * kGroupFloats + at + i] =
            static_cast<float>(size * random.uniform(settings.lowest, 1));
      }
      // Without both signs the mean of the pixels is above what they differ by.
      if (at == 0 && settings.lowest > -1) {
        planes[column * kGroupFloats] = static_cast<float>(8 * size);
      }
    }
  }
  return planes;
}

}  // namespace

std::vector<TileTransport> random_tiles(const RandomTransport& settings) {
  std::vector<TileTransport> tiles;
  for (std::size_t tile = 0; tile < settings.tile_count; ++tile) {
    TileBuilder builder(settings.column_count, {0x1p-24f, 0});
    for (std::size_t group = 0; group < TileBuilder::kGroups; ++group) {
      builder.add_group(group, random_planes(settings, tile, group));
    }
    tiles.push_back(builder.assemble());
  }
  return tiles;
}

Transport random_transport(const RandomTransport& settings) {
  return Transport(random_tiles(settings));
}

}  // namespace rimlight::test
