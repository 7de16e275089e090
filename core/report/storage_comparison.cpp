#include "core/report/storage_comparison.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/bake/check_lights.h"
#include "core/base/check.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/image/metrics.h"
#include "core/relight/relighter.h"
#include "core/report/measured_receivers.h"
#include "core/transport/reference_rows.h"

namespace rimlight {
namespace {

constexpr std::size_t kLanes = PixelLayout::kGroupReceivers;
constexpr std::size_t kRowFloats = 3 * kLanes;
/// Thresholds are so far apart, from the largest entry down.
constexpr double kThresholdsPerOctave = 4;
constexpr std::size_t kThresholds = 80;
constexpr std::size_t kCsrEntryBytes = 3 * sizeof(float) + sizeof(std::uint32_t);

/// The first threshold that keeps an entry whose largest channel is `size` of the largest of all;
/// kThresholds for none.
std::size_t first_threshold(float size) {
  if (!(size > 0)) return kThresholds;
  const double octaves = -std::log2(static_cast<double>(size));
  return std::min(kThresholds, static_cast<std::size_t>(octaves * kThresholdsPerOctave));
}

float largest_channel(const float* row, std::size_t lane) {
  return std::max(
      {std::abs(row[lane]), std::abs(row[kLanes + lane]), std::abs(row[2 * kLanes + lane])});
}

/// What each threshold keeps of the reference rows.
class PrunedRows {
 public:
  PrunedRows(const ReferenceRows& rows, std::span<const CubeLight> lights)
      : rows_(rows), lights_(lights) {
    std::vector<float> largest(rows.groups().size());
    parallel_for(largest.size(), [&](std::size_t group) {
      for (const float value : rows.group(group)) {
        // NaN counts as infinite.
        const float size = std::isfinite(value) ? std::abs(value) : INFINITY;
        largest[group] = std::max(largest[group], size);
      }
    });
    for (const float of_group : largest) largest_ = std::max(largest_, of_group);
    if (!(largest_ > 0) || !std::isfinite(largest_)) {
      throw Error("reference rows", "nothing in them, or what is not finite", "finite rows");
    }
  }

  void find_images(const std::function<void(double)>& progress) {
    const std::size_t groups = rows_.groups().size();
    images_.assign(kThresholds * lights_.size(), std::vector<Vec3f>(groups * kLanes));
    std::vector<std::array<std::size_t, kThresholds>> counts(groups);
    constexpr std::size_t kGroupsAtOnce = 16;
    for (std::size_t first = 0; first < groups; first += kGroupsAtOnce) {
      const std::size_t count = std::min(kGroupsAtOnce, groups - first);
      parallel_for(count, [&](std::size_t i) { add_group(first + i, counts[first + i]); });
      progress(static_cast<double>(first + count) / static_cast<double>(groups));
    }
    for (const auto& count : counts) {
      for (std::size_t i = 0; i < kThresholds; ++i) entries_[i] += count[i];
    }
    for (std::size_t i = 1; i < kThresholds; ++i) entries_[i] += entries_[i - 1];
  }

  /// Entries kept, of all groups.
  std::size_t entries(std::size_t threshold) const { return entries_[threshold]; }
  /// [group][64].
  const std::vector<Vec3f>& image(std::size_t threshold, std::size_t light) const {
    return images_[threshold * lights_.size() + light];
  }

 private:
  /// The group's images at every threshold: what the threshold adds, then the sums of those.
  void add_group(std::size_t group, std::array<std::size_t, kThresholds>& counts) {
    counts.fill(0);
    const float* row = rows_.group(group).data();
    const std::size_t columns = rows_.group(group).size() / kRowFloats;
    for (std::size_t column = 0; column < columns; ++column, row += kRowFloats) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const std::size_t threshold = first_threshold(largest_channel(row, lane) / largest_);
        if (threshold == kThresholds) continue;
        ++counts[threshold];
        const Vec3f entry = {row[lane], row[kLanes + lane], row[2 * kLanes + lane]};
        for (std::size_t light = 0; light < lights_.size(); ++light) {
          images_[threshold * lights_.size() + light][group * kLanes + lane] +=
              entry * lights_[light].at(column);
        }
      }
    }
    for (std::size_t i = lights_.size(); i < images_.size(); ++i) {
      for (std::size_t lane = group * kLanes; lane < (group + 1) * kLanes; ++lane) {
        images_[i][lane] += images_[i - lights_.size()][lane];
      }
    }
  }

  const ReferenceRows& rows_;
  std::span<const CubeLight> lights_;
  float largest_ = 0;
  std::array<std::size_t, kThresholds> entries_{};
  std::vector<std::vector<Vec3f>> images_;  // [threshold][light]
};

/// Error under the worst light; bytes are the caller's.
StoragePoint worst_of(const LightImages& images, const LightImages& references,
                      const std::vector<CheckLight>& lights) {
  const std::vector<double> exposures = check_exposures(lights, references);
  StoragePoint point;
  point.worst_psnr_db = std::numeric_limits<double>::infinity();
  for (std::size_t light = 0; light < lights.size(); ++light) {
    const double psnr = display_psnr(images[light], references[light], exposures[light]);
    if (psnr >= point.worst_psnr_db) continue;
    point.worst_psnr_db = psnr;
    point.worst_light = lights[light].name;
  }
  return point;
}

/// What the bake shows of each light.
LightImages stored_images(const Bake& bake, const CubeHaar& haar,
                          const MeasuredReceivers& receivers,
                          const std::vector<CheckLight>& lights) {
  Relighter relighter(bake.transport(), bake.reflectance(), haar);
  LightImages images(lights.size());
  for (std::size_t light = 0; light < lights.size(); ++light) {
    RIMLIGHT_CHECK(relighter.apply_exact(lights[light].coefficients, {}));
    receivers.gather(relighter, images[light]);
  }
  return images;
}

double stored_bytes_per_receiver(const Bake& bake) {
  const TransportView::Arrays& arrays = bake.transport().arrays();
  const std::size_t shared = arrays.runs.size_bytes() + arrays.run_offset.size_bytes() +
                             arrays.tile_first_word.size_bytes() + arrays.column_step.size_bytes();
  const auto covered = std::ranges::count_if(bake.coverage(), [](float c) { return c > 0; });
  return static_cast<double>(shared) / static_cast<double>(covered) + sizeof(Vec3f);
}

/// Bytes at an error between two points of the curve, by decibels.
double bytes_at(const std::vector<StoragePoint>& curve, double psnr_db) {
  const auto found = std::ranges::find_if(
      curve, [psnr_db](const StoragePoint& point) { return point.worst_psnr_db >= psnr_db; });
  if (found == curve.end()) return std::numeric_limits<double>::infinity();
  if (found == curve.begin()) return found->bytes_per_receiver;
  const StoragePoint &after = *found, &before = *(found - 1);
  const double share =
      (psnr_db - before.worst_psnr_db) / (after.worst_psnr_db - before.worst_psnr_db);
  return std::lerp(before.bytes_per_receiver, after.bytes_per_receiver, share);
}

}  // namespace

StorageComparison compare_storage(const Bake& bake, const std::function<void(double)>& progress) {
  const MeasuredReceivers receivers(bake);
  if (!receivers.has_rows()) {
    throw Error(bake.folder().string(), "no reference rows", "a bake made with --reference");
  }
  if (receivers.count() == 0) {
    throw Error(bake.folder().string(), "reference rows of no pixel that geometry covers",
                "some of those");
  }
  const CubeHaar haar(bake.manifest().cube_size);
  const std::vector<CheckLight> lights = make_check_lights(haar);
  const std::vector<CubeLight> coefficients = coefficients_of(lights);
  const LightImages references = receivers.reference(coefficients);

  StorageComparison result;
  result.scene = bake.manifest().scene;
  result.cube_size = haar.size();
  result.receivers = receivers.count();
  result.stored = worst_of(stored_images(bake, haar, receivers, lights), references, lights);
  result.stored.bytes_per_receiver = stored_bytes_per_receiver(bake);

  PrunedRows pruned(receivers.rows(), coefficients);
  pruned.find_images(progress);
  for (std::size_t threshold = 0; threshold < kThresholds; ++threshold) {
    LightImages images;
    for (std::size_t light = 0; light < lights.size(); ++light) {
      images.push_back(receivers.select(pruned.image(threshold, light)));
    }
    StoragePoint& point = result.csr.emplace_back(worst_of(images, references, lights));
    point.bytes_per_receiver = static_cast<double>(pruned.entries(threshold) * kCsrEntryBytes) /
                               static_cast<double>(receivers.count());
  }
  result.csr_bytes_at_stored_error = bytes_at(result.csr, result.stored.worst_psnr_db);
  return result;
}

}  // namespace rimlight
