#include "core/bake/image_bake.h"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <utility>

#include "core/bake/bake_output.h"
#include "core/bake/compression.h"
#include "core/bake/fingerprint.h"
#include "core/bake/group_baker.h"
#include "core/bake/pilot.h"
#include "core/bake/tile_store.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/math/random.h"
#include "core/transport/bake_folder.h"
#include "core/transport/receiver_planes.h"
#include "core/transport/tile_builder.h"

namespace rimlight {
namespace {

using Clock = std::chrono::steady_clock;

/// The compression that tiles are stored with at first is finer than the pilot asks for: a sample
/// may be kinder than the image. What that is too much is left out again, measured on the whole
/// image.
constexpr double kPilotMarginDb = 1;
constexpr float kFinerStep = 0.5f;  // for another attempt, when the pilot was wrong
constexpr int kMostAttempts = 4;

/// One lane of [3][64].
Vec3f lane_of(const float* row, std::size_t lane) {
  return {row[lane], row[kGroupLanes + lane], row[2 * kGroupLanes + lane]};
}

/// One bake from begin to end.
class ImageBake {
 public:
  ImageBake(const std::shared_ptr<const Scene>& scene, const std::filesystem::path& folder,
            const std::function<void(const BakeProgress&)>& progress)
      : scene_(scene),
        progress_(progress),
        haar_(scene->bake.cube_size),
        lights_(make_check_lights(haar_)),
        rays_(scene),
        baker_(rays_, lights_),
        writer_(folder) {}

  BakeSummary run() {
    const auto start = Clock::now();
    StorageStep storage = pilot();
    for (int attempt = 0;; ++attempt) {
      TileStore store(writer_.partial_folder() / "tiles", shape(),
                      mix_bits(fingerprint(*scene_) ^ std::bit_cast<std::uint32_t>(storage.step)));
      trace_tiles(store, storage);
      report("compressing", 0);
      const LightImages references = reference_images(store);
      const auto exposures = check_exposures(lights_, references);
      const auto least_energy =
          choose_least_energy(store, baker_.check_lights(), references, exposures,
                              storage.least_energy, scene_->bake.psnr_db);
      if (least_energy) {
        write(store, references, {storage.step, *least_energy}, start);
        return summary_;
      }
      // The pilot's groups were kinder than the image: everything again, finer.
      if (attempt + 1 == kMostAttempts) {
        throw Error(scene_->name, "no compression that keeps the error asked for",
                    "a lower /bake/psnr_db");
      }
      storage.step *= kFinerStep;
    }
  }

 private:
  TileStore::Shape shape() const {
    return {baker_.layout().tile_count(), haar_.coefficient_count(), lights_.size()};
  }

  void report(const char* stage, double fraction, bool resumed = false) const {
    if (progress_) progress_({stage, fraction, resumed});
  }

  /// How finely the tiles are stored at first.
  StorageStep pilot() {
    report("sampling", 0);
    const std::size_t groups = baker_.layout().receiver_count() / kGroupLanes;
    const std::size_t count = std::clamp<std::size_t>(groups / 16, 8, 128);
    const auto sample = sample_groups(baker_, count, scene_->bake.seed);
    if (sample.empty()) {
      throw Error(scene_->name, "a camera that sees no geometry", "an object in the picture");
    }
    return {pilot_step(baker_, sample, lights_, scene_->bake.psnr_db + kPilotMarginDb)};
  }

  void trace_tiles(const TileStore& store, const StorageStep& storage) {
    for (std::size_t tile = 0; tile < store.shape().tiles; ++tile) {
      const bool found = store.has(tile);
      if (found) {
        ++summary_.resumed_tiles;
      } else {
        trace_tile(store, tile, storage);
      }
      report("tracing", static_cast<double>(tile + 1) / static_cast<double>(store.shape().tiles),
             found);
    }
  }

  void trace_tile(const TileStore& store, std::size_t tile, const StorageStep& storage) const {
    TileBuilder builder(store.shape().columns, storage);
    TileCheck check;
    check.coverage.resize(kTileReceivers);
    check.reflectance.resize(kTileReceivers);
    check.images.assign(lights_.size(), std::vector<Vec3f>(kTileReceivers));
    parallel_for(TileBuilder::kGroups, [&](std::size_t place) {
      thread_local std::unique_ptr<BakedGroup> group;
      if (group == nullptr || group->coefficients.cube_size != haar_.size()) {
        group = std::make_unique<BakedGroup>(haar_.size(), lights_.size());
      }
      baker_.bake(tile * kTileReceivers + place * kGroupLanes, *group);
      std::array<float, kGroupFloats> reflectance{};
      if (!group->empty) {
        find_reflectance(group->coefficients.values, reflectance);
        to_planes(group->coefficients.values, reflectance);
        builder.add_group(place, group->coefficients.values);
      }
      for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
        const std::size_t receiver = place * kGroupLanes + lane;
        check.coverage[receiver] = group->coverage[lane];
        check.reflectance[receiver] = lane_of(reflectance.data(), lane);
        for (std::size_t light = 0; light < lights_.size(); ++light) {
          check.images[light][receiver] =
              lane_of(group->check_images.data() + light * kRowLanes, lane);
        }
      }
    });
    store.save(tile, builder.assemble(), check);
  }

  void write(const TileStore& store, const LightImages& references, const StorageStep& storage,
             Clock::time_point start) {
    report("writing", 0);
    const auto images = compressed_images(store, baker_.check_lights(), storage.least_energy);
    const std::vector<double> psnr =
        measure_psnr(images, references, check_exposures(lights_, references));
    summary_.bytes = write_transport(writer_, store, baker_.layout(), storage.least_energy);
    write_environments(writer_, store, *scene_, storage.least_energy);
    writer_.commit(describe(psnr, storage));
    summary_.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    report("writing", 1);
  }

  BakeManifest describe(const std::vector<double>& psnr, const StorageStep& storage) {
    const auto worst = std::min_element(psnr.begin(), psnr.end());
    summary_.worst_psnr_db = *worst;
    summary_.worst_light = lights_[static_cast<std::size_t>(worst - psnr.begin())].name;
    const BakeSettings& bake = scene_->bake;
    BakeManifest manifest;
    manifest.scene = scene_->name;
    manifest.pixels = baker_.layout();
    manifest.cube_size = haar_.size();
    manifest.camera = scene_->camera;
    manifest.settings = {{"primary_rays", bake.primary_rays},
                         {"bounces", bake.bounces},
                         {"psnr_db", bake.psnr_db},
                         {"seed", bake.seed}};
    for (std::size_t light = 0; light < lights_.size(); ++light) {
      manifest.measured["psnr_db"][lights_[light].name] = std::round(psnr[light] * 100) / 100;
    }
    manifest.left_out = {{"step", storage.step},
                         {"blocks_below", storage.step * std::sqrt(storage.least_energy)},
                         {"worst_psnr_db", summary_.worst_psnr_db},
                         {"worst_light", summary_.worst_light}};
    return manifest;
  }

  std::shared_ptr<const Scene> scene_;
  const std::function<void(const BakeProgress&)>& progress_;
  CubeHaar haar_;
  std::vector<CheckLight> lights_;
  RayScene rays_;
  GroupBaker baker_;
  BakeWriter writer_;
  BakeSummary summary_;
};

}  // namespace

BakeSummary bake_image(const std::shared_ptr<const Scene>& scene,
                       const std::filesystem::path& folder,
                       const std::function<void(const BakeProgress&)>& progress) {
  return ImageBake(scene, folder, progress).run();
}

}  // namespace rimlight
