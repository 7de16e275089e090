#include "core/bake/bake_output.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "core/bake/check_lights.h"
#include "core/bake/compression.h"
#include "core/basis/cube_haar.h"
#include "core/image/metrics.h"

namespace rimlight {
namespace {

void for_each_tile(const TileStore& store, float threshold,
                   const std::function<void(const TileTransport&)>& visit) {
  const std::vector<float> weights(store.shape().columns, 1.0f);
  for (std::size_t tile = 0; tile < store.shape().tiles; ++tile) {
    visit(prune(store.transport(tile), weights, threshold));
  }
}

/// [height][width] of 8 bits.
std::vector<std::uint8_t> gather_coverage(const TileStore& store, const PixelLayout& pixels) {
  std::vector<std::uint8_t> result(static_cast<std::size_t>(pixels.width) *
                                   static_cast<std::size_t>(pixels.height));
  for (std::size_t tile = 0; tile < store.shape().tiles; ++tile) {
    const TileCheck check = store.check(tile);
    for (std::size_t i = 0; i < kTileReceivers; ++i) {
      const PixelLayout::Pixel at = pixels.pixel(tile * kTileReceivers + i);
      if (at.x >= pixels.width || at.y >= pixels.height) continue;
      const auto index = static_cast<std::size_t>(at.y) * static_cast<std::size_t>(pixels.width) +
                         static_cast<std::size_t>(at.x);
      result[index] = static_cast<std::uint8_t>(std::lround(255 * check.coverage[i]));
    }
  }
  return result;
}

}  // namespace

std::size_t write_transport(BakeWriter& writer, const TileStore& store, const PixelLayout& pixels,
                            float threshold) {
  std::vector<std::uint64_t> tile_first_block{0};
  std::vector<std::uint32_t> column_offset;
  std::vector<float> column_scale;
  for_each_tile(store, threshold, [&](const TileTransport& tile) {
    tile_first_block.push_back(tile_first_block.back() + tile.block_count());
    column_offset.insert(column_offset.end(), tile.column_offset.begin(), tile.column_offset.end());
    column_scale.insert(column_scale.end(), tile.column_scale.begin(), tile.column_scale.end());
  });
  const std::size_t tiles = store.shape().tiles;
  const std::size_t columns = store.shape().columns;
  const std::size_t blocks = tile_first_block.back();
  const auto file = writer.create("transport.safetensors",
                                  {{"tile_first_block", ElementType::u64, {tiles + 1}},
                                   {"column_offset", ElementType::u32, {tiles, columns + 1}},
                                   {"column_scale", ElementType::f32, {tiles, columns}},
                                   {"block_index", ElementType::u16, {blocks}},
                                   {"value", ElementType::f16, {blocks, 3, kBlockReceivers}}});
  file->append(std::span<const std::uint64_t>(tile_first_block));
  file->append(std::span<const std::uint32_t>(column_offset));
  file->append(std::span<const float>(column_scale));
  for_each_tile(store, threshold, [&](const TileTransport& tile) {
    file->append(std::span<const std::uint16_t>(tile.block_index));
  });
  for_each_tile(store, threshold, [&](const TileTransport& tile) {
    file->append(std::as_bytes(std::span<const Half>(tile.value)));
  });
  writer.add_file("transport.safetensors", file->finish());

  const auto coverage = gather_coverage(store, pixels);
  const auto pixel_file = writer.create(
      "pixels.safetensors",
      {{"coverage",
        ElementType::u8,
        {static_cast<std::size_t>(pixels.height), static_cast<std::size_t>(pixels.width)}}});
  pixel_file->append(std::span<const std::uint8_t>(coverage));
  writer.add_file("pixels.safetensors", pixel_file->finish());
  return blocks;
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
