#include "core/bake/compression.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/parallel.h"
#include "core/image/metrics.h"
#include "core/transport/column_kernel.h"
#include "core/transport/receiver_planes.h"
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

std::vector<Vec3f> covered(const ReceiverValues& radiance, const std::vector<float>& coverage) {
  std::vector<Vec3f> result;
  for (std::size_t receiver = 0; receiver < kTileReceivers; ++receiver) {
    if (coverage[receiver] > 0) result.push_back(radiance.at(receiver));
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
                              float least_energy) {
  std::vector<std::vector<ColumnDelta>> deltas;
  for (const CubeLight& light : lights) deltas.push_back(all_columns(light));
  std::vector<LightImages> tiles(store.shape().tiles, LightImages(lights.size()));
  parallel_for(tiles.size(), [&](std::size_t tile) {
    const TileTransport kept = prune(store.transport(tile), least_energy);
    const std::array<std::uint64_t, 2> words = {0, kept.runs.size()};
    const TransportView view({.tile_count = 1,
                              .column_count = kept.column_count(),
                              .column_step = kept.column_step,
                              .tile_first_word = words,
                              .run_offset = kept.run_offset,
                              .runs = kept.runs},
                             "a finished tile");
    const TileCheck check = store.check(tile);
    ReceiverValues reflectance(1);
    for (std::size_t i = 0; i < kTileReceivers; ++i) reflectance.set(i, check.reflectance[i]);
    for (std::size_t light = 0; light < lights.size(); ++light) {
      ReceiverValues held(1);
      add_columns(view, 0, deltas[light], held.tile(0));
      restore_radiance(held.tile_span(0), reflectance.tile_span(0));
      tiles[tile][light] = covered(held, check.coverage);
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

std::optional<float> choose_least_energy(const TileStore& store, std::span<const CubeLight> lights,
                                         const LightImages& references,
                                         const std::vector<double>& exposures, float first,
                                         double psnr_db) {
  const auto energy_of = [first](int step) {
    return first * std::exp2(static_cast<float>(step) / 4);
  };
  const auto good = [&](int step) {
    const auto images = compressed_images(store, lights, energy_of(step));
    return worst(measure_psnr(images, references, exposures)) >= psnr_db;
  };
  if (!good(0)) return std::nullopt;
  int holds = 0;
  int fails = 17;
  while (fails - holds > 1) {
    const int middle = (holds + fails) / 2;
    (good(middle) ? holds : fails) = middle;
  }
  return energy_of(holds);
}

}  // namespace rimlight
