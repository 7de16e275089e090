// One receiver, and a million.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "core/bake/image_bake.h"
#include "core/base/half.h"
#include "core/basis/cube_haar.h"
#include "core/math/random.h"
#include "core/relight/relighter.h"
#include "core/report/stability/cases.h"
#include "core/report/stability/random_tiles.h"
#include "core/report/stability/small_scenes.h"
#include "core/transport/bake_folder.h"
#include "core/vertices/incremental_irradiance.h"

namespace rimlight::stability {
namespace {

/// A bake of a picture of one pixel, opened and lit, against the transport that it was made of.
StabilityMeasure one_pixel(const StabilityTrial& trial) {
  const auto scene = still_life();
  scene->bake.width = scene->bake.height = 1;
  const ScratchFolder folder;
  const auto place = folder.path() / "one.bake";
  bake_image(scene, place, {});
  const Bake bake(place);
  const CubeHaar haar(scene->bake.cube_size);
  Relighter relighter(bake.transport(), bake.reflectance(), haar);
  const CubeLight sky = uniform_sky(scene->bake.cube_size);
  static_cast<void>(relighter.apply_exact(coefficients_of(sky), {}));
  ReceiverValues shown(1);
  relighter.find_radiance(0, shown.tile_span(0));
  const auto expected = picture_of(scene, sky);
  if (expected.size() != 1) return {std::numeric_limits<double>::infinity()};
  const Vec3f value = shown.at(0) * trial.either(1.0f, 1.1f);
  return {length(Vec3d(value - expected[0])) / length(Vec3d(expected[0]))};
}

StabilityMeasure one_vertex(const StabilityTrial& trial) {
  constexpr std::size_t kCoefficients = 25;
  AlignedVector<Half> values(kCoefficients * kBatchVertices);
  Random random(1);
  std::vector<float> light(3 * kCoefficients);
  double expected = 0, size = 0;
  for (std::size_t i = 0; i < kCoefficients; ++i) {
    values[i * kBatchVertices] = to_half(static_cast<float>(random.uniform(-1, 1)));
    light[i] = static_cast<float>(random.uniform(-1, 1));
    const double term = double{to_float(values[i * kBatchVertices])} * double{light[i]};
    expected += term;
    size += std::abs(term);
  }
  const VertexTransportView view{
      .vertex_count = 1, .irradiance_degree = 4, .irradiance = values, .visibility = {}};
  IncrementalIrradiance irradiance(view);
  irradiance.set(light);
  double others = 0;  // padding stays black
  for (std::size_t lane = 1; lane < kBatchVertices; ++lane) {
    others = std::max(others, std::abs(double{irradiance.irradiance()[lane]}));
  }
  const double shown = double{irradiance.irradiance()[0]} + trial.either(0.0, 1e-3);
  return {std::max(others, std::abs(shown - expected) / size)};
}

/// The tiles of a picture of a million pixels, each as it would be alone: numbers that differ.
StabilityMeasure million_pixels(const StabilityTrial& trial) {
  const CubeHaar haar(4);
  const std::size_t tiles = trial.fast ? 20 : 245;  // 1,003,520 receivers
  const auto made =
      make_tiles({.tiles = tiles, .columns = haar.coefficient_count(), .density = 0.02});
  const Transport all(made);
  const ReceiverValues reflectance = white(tiles), alone_reflectance = white(1);
  const CubeLight light = random_sky(4);
  Relighter relighter(all.view(), reflectance, haar, HeldImages::together);
  static_cast<void>(relighter.apply_exact(light, {}));
  std::size_t different = 0;
  for (const std::size_t tile : {std::size_t{0}, tiles / 2, tiles - 1}) {
    const std::size_t other = trial.either(tile, tile / 2);
    const Transport one({&made[other], 1});
    Relighter alone(one.view(), alone_reflectance, haar, HeldImages::together);
    static_cast<void>(alone.apply_exact(light, {}));
    ReceiverValues a(1), b(1);
    relighter.find_radiance(tile, a.tile_span(0));
    alone.find_radiance(0, b.tile_span(0));
    for (std::size_t i = 0; i < kTileFloats; ++i) {
      different += std::memcmp(a.tile(0) + i, b.tile(0) + i, sizeof(float)) == 0 ? 0 : 1;
    }
  }
  return {static_cast<double>(different), std::to_string(tiles * kTileReceivers) + " receivers"};
}

/// A million vertices, some of them summed in double: error over Σ |terms|.
StabilityMeasure million_vertices(const StabilityTrial& trial) {
  const std::size_t vertices = trial.fast ? 50'000 : 1'000'000;
  constexpr std::size_t kCoefficients = 16;
  AlignedVector<Half> values(batch_count(vertices) * kCoefficients * kBatchVertices);
  Random random(2);
  for (Half& value : values) value = static_cast<Half>(random.below(0x3c00));  // 0 … 1
  const VertexTransportView view{
      .vertex_count = vertices, .irradiance_degree = 3, .irradiance = values, .visibility = {}};
  std::vector<float> light(3 * kCoefficients);
  for (float& value : light) value = static_cast<float>(random.uniform(-1, 1));
  IncrementalIrradiance irradiance(view);
  irradiance.set(light);
  double worst = 0;
  for (std::size_t vertex = 0; vertex < vertices; vertex += 997) {
    const std::size_t batch = vertex / kBatchVertices, lane = vertex % kBatchVertices;
    double sum = trial.either(0.0, 1e-3), size = 0;
    for (std::size_t i = 0; i < kCoefficients; ++i) {
      const Half half = values[(batch * kCoefficients + i) * kBatchVertices + lane];
      sum += double{to_float(half)} * double{light[i]};
      size += std::abs(double{to_float(half)} * double{light[i]});
    }
    const double shown = irradiance.irradiance()[batch * 3 * kBatchVertices + lane];
    worst = std::max(worst, std::abs(shown - sum) / size);
  }
  return {worst, std::to_string(vertices) + " vertices"};
}

}  // namespace

std::vector<StabilityCase> receivers_cases() {
  using enum BoundKind;
  const std::string part = "receivers";
  return {
      {"one-pixel", part, "relative error of a bake of one pixel under a uniform sky", at_most,
       0.01, "50 dB as displayed, at least, under the check lights", one_pixel},
      {"one-vertex", part, "error of one vertex' irradiance, and the padding's, over Σ |terms|",
       at_most, 25 * 0x1p-24, "25 additions, each rounded to 2⁻²⁴", one_vertex},
      {"million-pixels", part, "numbers of tiles that differ from those of the tile alone", at_most,
       0, "a tile is one thread's, whatever else there is", million_pixels},
      {"million-vertices", part, "error of irradiance over Σ |terms|, one vertex in 997", at_most,
       16 * 0x1p-24, "16 additions, each rounded to 2⁻²⁴", million_vertices},
  };
}

}  // namespace rimlight::stability
