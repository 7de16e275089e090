#include "tests/support/small_bake.h"

#include <memory>

#include "core/basis/cube_map.h"
#include "core/math/random.h"

namespace rimlight::test {
namespace {

RgbImage random_image(int width, int height, std::uint64_t seed) {
  RgbImage image(width, height);
  Random random(seed);
  for (Vec3f& pixel : image.pixels) {
    pixel = {random.uniform_float(), random.uniform_float(), random.uniform_float()};
  }
  return image;
}

}  // namespace

BakeManifest small_manifest(const SmallBake& settings) {
  BakeManifest manifest;
  manifest.scene = settings.scene;
  manifest.pixels = settings.pixels;
  manifest.cube_size = settings.cube_size;
  manifest.camera.position = {1, 2, 6};
  manifest.settings = {{"seed", settings.seed}};
  manifest.measured = {{"psnr_db", 51.5}};
  manifest.left_out = {{"blocks", 7}};
  return manifest;
}

std::vector<float> small_coverage(const SmallBake& settings) {
  std::vector<float> coverage;
  for (int y = 0; y < settings.pixels.height; ++y) {
    for (int x = 0; x < settings.pixels.width; ++x) {
      coverage.push_back(y < 20 ? 0.0f : x % 3 == 0 ? 0.5f : 1.0f);
    }
  }
  return coverage;
}

std::vector<Vec3f> small_reflectance(const SmallBake& settings) {
  Random random(settings.seed, 3);
  std::vector<Vec3f> reflectance;
  for (const float coverage : small_coverage(settings)) {
    const auto value = [&] { return static_cast<float>(coverage * random.uniform(0.2, 1)); };
    reflectance.push_back({value(), value(), value()});
  }
  return reflectance;
}

std::vector<TileTransport> small_tiles(const SmallBake& settings) {
  return random_tiles({.tile_count = settings.pixels.tile_count(),
                       .column_count = cube::texel_count(settings.cube_size),
                       .density = settings.density,
                       .lowest = settings.lowest,
                       .seed = settings.seed});
}

std::vector<BakedEnvironment> small_environments() {
  RgbImage sky = random_image(16, 8, 1);
  sky.at(11, 2) = {900, 800, 600};
  return {{std::make_shared<Environment>("sky", std::move(sky), EnvironmentLayout::lat_long), 0.5},
          {std::make_shared<Environment>("room", random_image(24, 4, 2), EnvironmentLayout::cube),
           1.25}};
}

void fill(BakeWriter& writer, const SmallBake& settings) {
  const auto tiles = small_tiles(settings);
  writer.add_transport(tiles.size(), [&](std::size_t t) { return tiles[t]; });
  writer.add_pixels(settings.pixels, small_coverage(settings), small_reflectance(settings));
  // Sums of nothing: as if all of the transport were compression's error.
  const SketchSums sums(cube::texel_count(settings.cube_size), 1);
  writer.add_sketch(sums, settings.pixels);
  for (const BakedEnvironment& environment : small_environments()) {
    writer.add_environment(environment);
  }
}

void write_small_bake(const std::filesystem::path& folder, const SmallBake& settings) {
  BakeWriter writer(folder);
  fill(writer, settings);
  writer.commit(small_manifest(settings));
}

}  // namespace rimlight::test
