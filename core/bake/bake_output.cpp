#include "core/bake/bake_output.h"

#include <vector>

namespace rimlight {
namespace {

/// [height][width].
struct Pixels {
  std::vector<float> coverage;
  std::vector<Vec3f> reflectance;
};

Pixels gather_pixels(const TileStore& store, const PixelLayout& pixels) {
  const std::size_t count =
      static_cast<std::size_t>(pixels.width) * static_cast<std::size_t>(pixels.height);
  Pixels result{std::vector<float>(count), std::vector<Vec3f>(count)};
  for (std::size_t tile = 0; tile < store.shape().tiles; ++tile) {
    const TileCheck check = store.check(tile);
    for (std::size_t i = 0; i < kTileReceivers; ++i) {
      const PixelLayout::Pixel at = pixels.pixel(tile * kTileReceivers + i);
      if (at.x >= pixels.width || at.y >= pixels.height) continue;
      const std::size_t pixel =
          static_cast<std::size_t>(at.y) * static_cast<std::size_t>(pixels.width) +
          static_cast<std::size_t>(at.x);
      result.coverage[pixel] = check.coverage[i];
      result.reflectance[pixel] = check.reflectance[i];
    }
  }
  return result;
}

}  // namespace

std::size_t write_transport(BakeWriter& writer, const TileStore& store, const PixelLayout& pixels,
                            float least_energy) {
  const std::size_t bytes = writer.add_transport(store.shape().tiles, [&](std::size_t tile) {
    return prune(store.transport(tile), least_energy);
  });
  const Pixels gathered = gather_pixels(store, pixels);
  writer.add_pixels(pixels, gathered.coverage, gathered.reflectance);
  return bytes;
}

}  // namespace rimlight
