#include "core/bake/bake_output.h"

#include <memory>
#include <numeric>
#include <vector>

#include "core/bake/check_lights.h"
#include "core/bake/compression.h"
#include "core/basis/cube_haar.h"
#include "core/image/metrics.h"

namespace rimlight {
namespace {

/// [height][width], in [0, 1].
std::vector<float> gather_coverage(const TileStore& store, const PixelLayout& pixels) {
  std::vector<float> result(static_cast<std::size_t>(pixels.width) *
                            static_cast<std::size_t>(pixels.height));
  for (std::size_t tile = 0; tile < store.shape().tiles; ++tile) {
    const TileCheck check = store.check(tile);
    for (std::size_t i = 0; i < kTileReceivers; ++i) {
      const PixelLayout::Pixel at = pixels.pixel(tile * kTileReceivers + i);
      if (at.x >= pixels.width || at.y >= pixels.height) continue;
      result[static_cast<std::size_t>(at.y) * static_cast<std::size_t>(pixels.width) +
             static_cast<std::size_t>(at.x)] = check.coverage[i];
    }
  }
  return result;
}

}  // namespace

std::size_t write_transport(BakeWriter& writer, const TileStore& store, const PixelLayout& pixels,
                            float threshold) {
  const std::vector<float> weights(store.shape().columns, 1.0f);
  std::vector<std::size_t> blocks(store.shape().tiles);
  TileTransport pruned;
  writer.add_transport(store.shape().tiles, [&](std::size_t tile) -> const TileTransport& {
    pruned = prune(store.transport(tile), weights, threshold);
    blocks[tile] = pruned.block_count();
    return pruned;
  });
  writer.add_coverage(pixels, gather_coverage(store, pixels));
  return std::accumulate(blocks.begin(), blocks.end(), std::size_t{0});
}

void write_environments(BakeWriter& writer, const TileStore& store, const Scene& scene,
                        float threshold) {
  const CubeHaar haar(scene.bake.cube_size);
  std::vector<CubeLight> lights;
  for (const Environment& environment : scene.environments) {
    lights.push_back(to_coefficients(haar, environment.project(haar.size())));
  }
  const LightImages images = compressed_images(store, lights, threshold);
  for (std::size_t i = 0; i < lights.size(); ++i) {
    writer.add_environment({std::make_shared<const Environment>(scene.environments[i]),
                            auto_exposure_scale(images[i])});
  }
}

}  // namespace rimlight
