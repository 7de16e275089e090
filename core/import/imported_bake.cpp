#include "core/import/imported_bake.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <system_error>

#include "core/bake/bake_output.h"
#include "core/bake/compression.h"
#include "core/bake/lane_kernel.h"
#include "core/bake/tile_store.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/basis/cube_haar.h"
#include "core/import/import_pilot.h"
#include "core/transport/tile_builder.h"

namespace rimlight {
namespace {

/// The tiles are stored finer at first than the pilot asks for, so that the final threshold,
/// measured on the whole picture, can be found above it.
constexpr double kPilotMarginDb = 0.5;
constexpr float kFirstThresholdShare = 0.5f;
constexpr int kMostAttempts = 6;

class ImportedBake {
 public:
  ImportedBake(const std::filesystem::path& folder, const ImportedTransport& transport,
               double psnr_db, const std::function<void(const BakeProgress&)>& progress)
      : writer_(folder),
        transport_(transport),
        psnr_db_(psnr_db),
        progress_(progress),
        haar_(transport.manifest.cube_size),
        lights_(make_check_lights(haar_)) {
    for (const CheckLight& light : lights_) check_lights_.push_back(light.coefficients);
  }

  ImportedBakeSummary run() {
    report("sampling", 0);
    float threshold = kFirstThresholdShare * static_cast<float>(import_threshold(
                                                 transport_, lights_, psnr_db_ + kPilotMarginDb));
    for (int attempt = 0; attempt < kMostAttempts; ++attempt, threshold *= kFirstThresholdShare) {
      // Tiles of an earlier import, or of a bake of this name, are not of this transport.
      const auto tiles = writer_.partial_folder() / "tiles";
      std::error_code ignored;
      std::filesystem::remove_all(tiles, ignored);
      const TileStore store(tiles,
                            {pixels().tile_count(), haar_.coefficient_count(), lights_.size()}, 0);
      store_tiles(store, threshold);
      report("compressing", 0);
      const LightImages references = reference_images(store);
      const auto exposures = check_exposures(lights_, references);
      const float chosen =
          choose_threshold(store, check_lights_, references, exposures, threshold, psnr_db_);
      if (chosen > 0) return write(store, references, exposures, chosen);
    }
    throw Error(transport_.manifest.scene, "no compression that keeps the error asked for",
                "a lower PSNR");
  }

 private:
  const PixelLayout& pixels() const { return transport_.manifest.pixels; }

  void report(const char* stage, double fraction) const {
    if (progress_) progress_({stage, fraction, false});
  }

  float coverage_of(std::size_t receiver) const {
    const auto [x, y] = pixels().pixel(receiver);
    if (x >= pixels().width || y >= pixels().height) return 0;
    return transport_
        .coverage[static_cast<std::size_t>(y) * static_cast<std::size_t>(pixels().width) +
                  static_cast<std::size_t>(x)];
  }

  void store_tiles(const TileStore& store, float threshold) const {
    const std::vector<float> weights(haar_.coefficient_count(), 1.0f);
    for (std::size_t tile = 0; tile < store.shape().tiles; ++tile) {
      TileBuilder builder(weights, threshold);
      TileCheck check;
      check.coverage.resize(kTileReceivers);
      check.images.assign(lights_.size(), std::vector<Vec3f>(kTileReceivers));
      parallel_for(TileBuilder::kGroups, [&](std::size_t place) {
        add_group(tile * kTileReceivers, place, builder, check);
      });
      store.save(tile, builder.assemble(), check);
      report("storing", static_cast<double>(tile + 1) / static_cast<double>(store.shape().tiles));
    }
  }

  void add_group(std::size_t first_of_tile, std::size_t place, TileBuilder& builder,
                 TileCheck& check) const {
    const std::size_t first = place * kGroupLanes;
    float covered = 0;
    for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
      check.coverage[first + lane] = coverage_of(first_of_tile + first + lane);
      covered += check.coverage[first + lane];
    }
    if (covered == 0) return;
    thread_local std::unique_ptr<GroupRows> rows;
    if (rows == nullptr || rows->cube_size != haar_.size()) {
      rows = std::make_unique<GroupRows>(haar_.size());
    }
    transport_.rows(first_of_tile + first, *rows);
    builder.add_group(place, rows->values);
    AlignedVector<float> images(lights_.size() * kRowLanes);
    multiply_rows(*rows, check_lights_, images.data());
    for (std::size_t light = 0; light < lights_.size(); ++light) {
      for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
        const float* const image = images.data() + light * kRowLanes + lane;
        check.images[light][first + lane] = {image[0], image[kGroupLanes], image[2 * kGroupLanes]};
      }
    }
  }

  ImportedBakeSummary write(const TileStore& store, const LightImages& references,
                            const std::vector<double>& exposures, float threshold) {
    report("writing", 0);
    const std::vector<double> psnr =
        measure_psnr(compressed_images(store, check_lights_, threshold), references, exposures);
    const auto worst = std::min_element(psnr.begin(), psnr.end());
    ImportedBakeSummary summary{write_transport(writer_, store, pixels(), threshold), *worst,
                                lights_[static_cast<std::size_t>(worst - psnr.begin())].name};
    Scene scene;  // for its environments
    scene.environments = transport_.environments;
    scene.bake.cube_size = haar_.size();
    write_environments(writer_, store, scene, threshold);
    BakeManifest manifest = transport_.manifest;
    for (std::size_t light = 0; light < lights_.size(); ++light) {
      manifest.measured["psnr_db"][lights_[light].name] = std::round(psnr[light] * 100) / 100;
    }
    manifest.left_out = {{"blocks_below", threshold},
                         {"worst_psnr_db", summary.worst_psnr_db},
                         {"worst_light", summary.worst_light}};
    writer_.commit(manifest);
    report("writing", 1);
    return summary;
  }

  BakeWriter writer_;
  const ImportedTransport& transport_;
  double psnr_db_;
  const std::function<void(const BakeProgress&)>& progress_;
  CubeHaar haar_;
  std::vector<CheckLight> lights_;
  std::vector<CubeLight> check_lights_;  // their coefficients
};

}  // namespace

ImportedBakeSummary write_imported_bake(const std::filesystem::path& folder,
                                        const ImportedTransport& transport, double psnr_db,
                                        const std::function<void(const BakeProgress&)>& progress) {
  return ImportedBake(folder, transport, psnr_db, progress).run();
}

}  // namespace rimlight
