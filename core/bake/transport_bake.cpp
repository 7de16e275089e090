#include "core/bake/transport_bake.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <utility>

#include "core/bake/bake_output.h"
#include "core/bake/compression.h"
#include "core/bake/lane_kernel.h"
#include "core/bake/pilot.h"
#include "core/bake/reference_output.h"
#include "core/bake/tile_store.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/base/stopwatch.h"
#include "core/image/metrics.h"
#include "core/math/random.h"
#include "core/transport/bake_folder.h"
#include "core/transport/receiver_planes.h"
#include "core/transport/sketch.h"
#include "core/transport/tile_builder.h"

namespace rimlight {
namespace {

/// The compression that tiles are stored with at first is finer than the pilot asks for: a sample
/// may be kinder than the image. What that is too much is left out again, measured on the whole
/// image.
constexpr double kPilotMarginDb = 1;
constexpr float kFinerStep = 0.5f;  // for another attempt, when the pilot was wrong
constexpr int kMostAttempts = 4;

/// Sketch sums count in this part of a step: finer than what storing rounds to.
constexpr float kSumsPerStep = 16;

/// Sketch sums are many megabytes: kept no more often than this, so that resuming loses about as
/// much work at most.
constexpr double kKeepSumsEveryMs = 5000;

/// The reflectance of a tile's group in lanes: [3][64].
std::array<float, kGroupFloats> reflectance_of(const TileCheck& check, std::size_t first) {
  std::array<float, kGroupFloats> result;
  for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
    for (std::size_t c = 0; c < 3; ++c) {
      result[c * kGroupLanes + lane] = check.reflectance[first + lane][static_cast<int>(c)];
    }
  }
  return result;
}

/// One lane of [3][64].
Vec3f lane_of(const float* row, std::size_t lane) {
  return {row[lane], row[kGroupLanes + lane], row[2 * kGroupLanes + lane]};
}

/// One bake from begin to end.
class TransportBake {
 public:
  TransportBake(const GroupSource& source, const BakeRequest& request,
                const std::filesystem::path& folder,
                const std::function<void(const BakeProgress&)>& progress)
      : source_(source),
        request_(request),
        progress_(progress),
        haar_(source.cube_size()),
        lights_(make_check_lights(haar_)),
        check_lights_(coefficients_of(lights_)),
        writer_(folder) {}

  BakeSummary run() {
    const Stopwatch watch;
    StorageStep storage = pilot();
    for (int attempt = 0;; ++attempt) {
      TileStore store(writer_.partial_folder() / "tiles", shape(),
                      mix_bits(request_.fingerprint ^ std::bit_cast<std::uint32_t>(storage.step)));
      SketchSums sums(shape().columns, storage.step / kSumsPerStep);
      make_tiles(store, storage, sums);
      report("compressing", 0);
      const LightImages references = reference_images(store);
      const auto exposures = check_exposures(lights_, references);
      const auto least_energy = choose_least_energy(store, check_lights_, references, exposures,
                                                    storage.least_energy, request_.psnr_db);
      if (least_energy) {
        write(store, references, {storage.step, *least_energy}, sums);
        summary_.seconds = watch.elapsed_seconds();
        return summary_;
      }
      // The pilot's groups were kinder than the image: everything again, finer.
      if (attempt + 1 == kMostAttempts) {
        throw Error(request_.scene, "no compression that keeps the error asked for",
                    "a lower psnr_db");
      }
      storage.step *= kFinerStep;
    }
  }

 private:
  TileStore::Shape shape() const {
    return {source_.layout().tile_count(), haar_.coefficient_count(), lights_.size()};
  }

  void report(const char* stage, double fraction, bool resumed = false) const {
    if (progress_) progress_({stage, fraction, resumed});
  }

  /// How finely the tiles are stored at first.
  StorageStep pilot() {
    report("sampling", 0);
    const std::size_t groups = source_.layout().receiver_count() / kGroupLanes;
    const std::size_t count = std::clamp<std::size_t>(groups / 16, 8, 128);
    const auto sample = sample_groups(source_, count, request_.seed);
    if (sample.empty()) {
      throw Error(request_.scene, "nothing in the picture", "an object that the camera sees");
    }
    return {pilot_step(source_, sample, lights_, request_.psnr_db + kPilotMarginDb)};
  }

  void make_tiles(const TileStore& store, const StorageStep& storage, SketchSums& sums) {
    const std::size_t summed = store.load_sums(sums);
    Stopwatch since_kept;
    for (std::size_t tile = 0; tile < store.shape().tiles; ++tile) {
      const bool found = tile < summed && store.has(tile);
      if (found) {
        ++summary_.resumed_tiles;
      } else {
        make_tile(store, tile, storage, tile < summed ? nullptr : &sums);
      }
      const bool last = tile + 1 == store.shape().tiles;
      if (tile >= summed && (tile == 0 || last || since_kept.elapsed_ms() > kKeepSumsEveryMs)) {
        store.save_sums(tile + 1, sums);
        since_kept.lap_ms();
      }
      report(request_.stage.c_str(),
             static_cast<double>(tile + 1) / static_cast<double>(store.shape().tiles), found);
    }
  }

  /// `sums` is null when they hold this tile.
  void make_tile(const TileStore& store, std::size_t tile, const StorageStep& storage,
                 SketchSums* sums) const {
    TileBuilder builder(store.shape().columns, storage);
    TileCheck check;
    check.coverage.resize(kTileReceivers);
    check.reflectance.resize(kTileReceivers);
    check.images.assign(lights_.size(), std::vector<Vec3f>(kTileReceivers));
    parallel_for(TileBuilder::kGroups, [&](std::size_t place) {
      thread_local std::unique_ptr<BakedGroup> group;
      if (group == nullptr || group->coefficients.cube_size != haar_.size()) {
        group = std::make_unique<BakedGroup>(haar_.size());
      }
      const std::size_t first_receiver = tile * kTileReceivers + place * kGroupLanes;
      source_.find_rows(first_receiver, *group);
      if (group->empty) return;
      if (sums != nullptr) sums->add_group(first_receiver, group->coefficients.values);
      add_check(*group, place * kGroupLanes, check);
      to_planes(group->coefficients.values, reflectance_of(check, place * kGroupLanes));
      builder.add_group(place, group->coefficients.values);
    });
    store.save(tile, builder.assemble(), check);
  }

  /// A group's coverage, reflectance and check images, from its rows.
  void add_check(const BakedGroup& group, std::size_t first, TileCheck& check) const {
    std::array<float, kGroupFloats> reflectance;
    find_reflectance(group.coefficients.values, reflectance);
    AlignedVector<float> images(lights_.size() * kRowLanes);
    multiply_rows(group.coefficients, check_lights_, images.data());
    for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
      check.coverage[first + lane] = group.coverage[lane];
      check.reflectance[first + lane] = lane_of(reflectance.data(), lane);
      for (std::size_t light = 0; light < lights_.size(); ++light) {
        check.images[light][first + lane] = lane_of(images.data() + light * kRowLanes, lane);
      }
    }
  }

  void write(const TileStore& store, const LightImages& references, const StorageStep& storage,
             const SketchSums& sums) {
    report("writing", 0);
    std::vector<CubeLight> lights = check_lights_;
    for (const Environment& environment : request_.environments) {
      lights.push_back(to_coefficients(haar_, environment.project(haar_.size())));
    }
    LightImages images = compressed_images(store, lights, storage.least_energy);
    for (std::size_t i = 0; i < request_.environments.size(); ++i) {
      if (request_.curves != nullptr) {
        add_covered(store, request_.curves->images[i], images[check_lights_.size() + i]);
      }
      writer_.add_environment({std::make_shared<const Environment>(request_.environments[i]),
                               auto_exposure_scale(images[check_lights_.size() + i])});
    }
    images.resize(check_lights_.size());
    const std::vector<double> psnr =
        measure_psnr(images, references, check_exposures(lights_, references));
    summary_.bytes = write_transport(writer_, store, source_.layout(), storage.least_energy);
    writer_.add_sketch(sums, source_.layout());
    if (request_.reference_receivers > 0) {
      report("keeping reference rows", 0);
      write_reference(writer_, {source_, request_.retraced, request_.finer},
                      request_.reference_receivers);
    }
    if (request_.curves != nullptr) writer_.add_curves(request_.curves->receivers);
    writer_.commit(describe(psnr, storage));
    report("writing", 1);
  }

  /// Adds an image of all receivers to one of those that geometry covers.
  static void add_covered(const TileStore& store, const std::vector<Vec3f>& all,
                          std::vector<Vec3f>& covered) {
    std::size_t next = 0;
    for (std::size_t tile = 0; tile < store.shape().tiles; ++tile) {
      const TileCheck check = store.check(tile);
      for (std::size_t i = 0; i < kTileReceivers; ++i) {
        if (check.coverage[i] > 0) covered[next++] += all[tile * kTileReceivers + i];
      }
    }
  }

  BakeManifest describe(const std::vector<double>& psnr, const StorageStep& storage) {
    const auto worst = std::min_element(psnr.begin(), psnr.end());
    summary_.worst_psnr_db = *worst;
    summary_.worst_light = lights_[static_cast<std::size_t>(worst - psnr.begin())].name;
    BakeManifest manifest;
    manifest.scene = request_.scene;
    manifest.pixels = source_.layout();
    manifest.cube_size = haar_.size();
    manifest.camera = request_.camera;
    manifest.settings = request_.settings;
    manifest.measured = request_.measured;
    for (std::size_t light = 0; light < lights_.size(); ++light) {
      manifest.measured["psnr_db"][lights_[light].name] = std::round(psnr[light] * 100) / 100;
    }
    manifest.left_out = {{"step", storage.step},
                         {"blocks_below", storage.step * std::sqrt(storage.least_energy)},
                         {"worst_psnr_db", summary_.worst_psnr_db},
                         {"worst_light", summary_.worst_light}};
    if (request_.curves != nullptr) {
      manifest.materials = request_.curves->materials;
      manifest.measured_brdfs = request_.curves->measured;
    }
    return manifest;
  }

  const GroupSource& source_;
  const BakeRequest& request_;
  const std::function<void(const BakeProgress&)>& progress_;
  CubeHaar haar_;
  std::vector<CheckLight> lights_;
  std::vector<CubeLight> check_lights_;
  BakeWriter writer_;
  BakeSummary summary_;
};

}  // namespace

BakeSummary bake_transport(const GroupSource& source, const BakeRequest& request,
                           const std::filesystem::path& folder,
                           const std::function<void(const BakeProgress&)>& progress) {
  return TransportBake(source, request, folder, progress).run();
}

}  // namespace rimlight
