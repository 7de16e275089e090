#include "core/bake/compression.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/parallel.h"
#include "core/image/metrics.h"
#include "core/transport/column_kernel.h"
#include "core/transport/receivers.h"

namespace rimlight {
namespace {

/// All columns of a light that are not zero, in canonical order.
std::vector<ColumnDelta> all_columns(const CubeLight& light) {
  std::vector<ColumnDelta> deltas;
  for (std::size_t column = 0; column < light.count(); ++column) {
    const Vec3f value = light.at(column);
    if (value != Vec3f{}) deltas.push_back({static_cast<std::uint32_t>(column), value});
  }
  return deltas;
}

std::vector<Vec3f> covered(const Radiance& radiance, const std::vector<float>& coverage) {
  std::vector<Vec3f> result;
  for (std::size_t receiver = 0; receiver < kTileReceivers; ++receiver) {
    if (!(coverage[receiver] > 0)) continue;
    result.emplace_back(radiance.at(receiver, 0), radiance.at(receiver, 1),
                        radiance.at(receiver, 2));
  }
  return result;
}

/// Joins the tiles' pieces, [tile][light][receiver], in tile order.
LightImages join(const std::vector<LightImages>& tiles, std::size_t lights) {
  LightImages images(lights);
  for (const LightImages& tile : tiles) {
    for (std::size_t light = 0; light < lights; ++light) {
      images[light].insert(images[light].end(), tile[light].begin(), tile[light].end());
    }
  }
  return images;
}

double worst(const std::vector<double>& psnr) {
  return psnr.empty() ? 99 : *std::min_element(psnr.begin(), psnr.end());
}

}  // namespace

LightImages compressed_images(const TileStore& store, std::span<const CubeLight> lights,
                              float threshold) {
  std::vector<std::vector<ColumnDelta>> deltas;
  for (const CubeLight& light : lights) deltas.push_back(all_columns(light));
  const std::vector<float> weights(store.shape().columns, 1.0f);
  std::vector<LightImages> tiles(store.shape().tiles, LightImages(lights.size()));
  parallel_for(tiles.size(), [&](std::size_t tile) {
    const TileTransport kept = prune(store.transport(tile), weights, threshold);
    const std::array<std::uint64_t, 2> blocks = {0, kept.block_count()};
    const TransportView view({.tile_count = 1,
                              .column_count = kept.column_count(),
                              .tile_first_block = blocks,
                              .column_offset = kept.column_offset,
                              .column_scale = kept.column_scale,
                              .block_index = kept.block_index,
                              .values = kept.value},
                             "a finished tile");
    const std::vector<float> coverage = store.check(tile).coverage;
    for (std::size_t light = 0; light < lights.size(); ++light) {
      Radiance radiance(1);
      add_columns(view, 0, deltas[light], radiance.tile(0));
      tiles[tile][light] = covered(radiance, coverage);
    }
  });
  return join(tiles, lights.size());
}

LightImages reference_images(const TileStore& store) {
  std::vector<LightImages> tiles(store.shape().tiles, LightImages(store.shape().lights));
  parallel_for(tiles.size(), [&](std::size_t tile) {
    const TileCheck check = store.check(tile);
    for (std::size_t light = 0; light < check.images.size(); ++light) {
      for (std::size_t receiver = 0; receiver < kTileReceivers; ++receiver) {
        if (check.coverage[receiver] > 0) {
          tiles[tile][light].push_back(check.images[light][receiver]);
        }
      }
    }
  });
  return join(tiles, store.shape().lights);
}

std::vector<double> measure_psnr(const LightImages& images, const LightImages& references,
                                 const std::vector<double>& exposures) {
  std::vector<double> result(images.size());
  parallel_for(images.size(), [&](std::size_t light) {
    result[light] = display_psnr(images[light], references[light], exposures[light]);
  });
  return result;
}

float choose_threshold(const TileStore& store, std::span<const CubeLight> lights,
                       const LightImages& references, const std::vector<double>& exposures,
                       float first_threshold, double psnr_db) {
  const auto threshold_of = [first_threshold](int step) {
    return first_threshold * std::exp2(static_cast<float>(step) / 8);
  };
  const auto good = [&](int step) {
    const auto images = compressed_images(store, lights, threshold_of(step));
    return worst(measure_psnr(images, references, exposures)) >= psnr_db;
  };
  if (!good(0)) return 0;
  int holds = 0;
  int fails = 17;
  while (fails - holds > 1) {
    const int middle = (holds + fails) / 2;
    (good(middle) ? holds : fails) = middle;
  }
  return threshold_of(holds);
}

}  // namespace rimlight
