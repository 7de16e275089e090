#include "tests/support/random_transport.h"

#include <algorithm>
#include <cmath>

#include "core/math/random.h"
#include "core/transport/tile_builder.h"

namespace rimlight::test {
namespace {

constexpr std::size_t kRow = 3 * PixelLayout::kGroupReceivers;

/// The share of blocks that a column has in a tile: none, all, or the density asked for.
double column_density(const RandomTransport& settings, std::size_t tile, std::size_t column) {
  Random random(settings.seed, 1'000'000 + tile * settings.column_count + column);
  const double u = random.uniform();
  if (u < settings.empty_columns) return 0;
  return u > 0.98 ? 1 : settings.density;
}

std::vector<float> random_rows(const RandomTransport& settings, std::size_t tile,
                               std::size_t group) {
  std::vector<float> rows(settings.column_count * kRow);
  Random random(settings.seed, tile * TileBuilder::kGroups + group);
  for (std::size_t column = 0; column < settings.column_count; ++column) {
    const double density = column_density(settings, tile, column);
    for (std::size_t block = 0; block < TileBuilder::kGroupBlocks; ++block) {
      if (random.uniform() >= density) continue;
      const double size = std::pow(10.0, random.uniform(-6, 0));
      for (std::size_t i = 0; i < kBlockFloats; ++i) {
        rows[column * kRow + i / kBlockReceivers * PixelLayout::kGroupReceivers +
             block * kBlockReceivers + i % kBlockReceivers] =
            static_cast<float>(size * random.uniform(settings.lowest, 1));
      }
    }
  }
  return rows;
}

}  // namespace

std::vector<TileTransport> random_tiles(const RandomTransport& settings) {
  const std::vector<float> weights(settings.column_count, 1.0f);
  std::vector<TileTransport> tiles;
  for (std::size_t tile = 0; tile < settings.tile_count; ++tile) {
    TileBuilder builder(weights, 0);
    for (std::size_t group = 0; group < TileBuilder::kGroups; ++group) {
      builder.add_group(group, random_rows(settings, tile, group));
    }
    tiles.push_back(builder.assemble());
  }
  return tiles;
}

Transport random_transport(const RandomTransport& settings) {
  return Transport(random_tiles(settings));
}

}  // namespace rimlight::test
