#include "core/bake/pilot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/bake/lane_kernel.h"
#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/image/metrics.h"
#include "core/math/random.h"
#include "core/transport/pixel_haar.h"
#include "core/transport/receiver_planes.h"
#include "core/transport/tile_builder.h"

namespace rimlight {
namespace {

/// Steps tried: 2^(−k) · what the source says is the typical size of M's numbers.
constexpr int kFirstOctave = 3;
constexpr int kOctaves = 16;

float step_of(int octave, float typical_size) {
  return std::exp2(-static_cast<float>(kFirstOctave + octave)) * typical_size;
}

/// A group's images under each light: as stored at each step, and of the whole transport.
struct PilotGroup {
  AlignedVector<float> by_step;  // [octave][light][kRowLanes]
  AlignedVector<float> whole;    // [light][kRowLanes]
  std::array<bool, kGroupLanes> seen{};
};

/// What a group of planes holds of each light once they are stored: sums [light][kRowLanes].
void add_stored(const GroupRows& planes, const StorageStep& storage,
                const std::vector<CheckLight>& lights, float* sums) {
  const std::size_t columns = planes.values.size() / kRowLanes;
  const float to_steps = 1 / storage.step;
  for (std::size_t column = 0; column < columns; ++column) {
    for (std::size_t at = 0; at < kRowLanes; at += kBlockReceivers) {
      std::array<float, kBlockReceivers> value;
      float energy = 0;
      for (std::size_t i = 0; i < kBlockReceivers; ++i) {
        value[i] = round_to_whole(planes.row(column)[at + i] * to_steps);
        energy += value[i] * value[i];
      }
      if (energy == 0 || energy < storage.least_energy) continue;
      const Vec3f factor = kPlaneFactors[at / kGroupLanes] * storage.step;
      for (std::size_t light = 0; light < lights.size(); ++light) {
        const Vec3f weight = lights[light].coefficients.at(column) * factor;
        float* const sum = sums + light * kRowLanes + at % kGroupLanes;
        for (std::size_t c = 0; c < 3; ++c) {
          const float of_channel = weight[static_cast<int>(c)];
          for (std::size_t i = 0; i < kBlockReceivers; ++i) {
            sum[c * kGroupLanes + i] += of_channel * value[i];
          }
        }
      }
    }
  }
}

/// Fills by_step from a baked group, whose coefficients become planes.
void store_at_each_step(const std::vector<CheckLight>& lights, float typical_size,
                        BakedGroup& baked, PilotGroup& result) {
  std::array<float, kGroupFloats> reflectance;
  find_reflectance(baked.coefficients.values, reflectance);
  to_planes(baked.coefficients.values, reflectance);
  const std::size_t stride = lights.size() * kRowLanes;
  result.by_step.resize(kOctaves * stride);
  for (int octave = 0; octave < kOctaves; ++octave) {
    float* const sums = result.by_step.data() + static_cast<std::size_t>(octave) * stride;
    add_stored(baked.coefficients, {step_of(octave, typical_size)}, lights, sums);
    for (std::size_t at = 0; at < stride; at += kRowLanes) {
      for (std::size_t c = 0; c < 3; ++c) {
        pixel_haar_inverse(sums + at + c * kGroupLanes, kBlockReceivers);
      }
      for (std::size_t i = 0; i < kRowLanes; ++i) sums[at + i] *= reflectance[i];
    }
  }
}

/// The pilot's receivers from an image [kRowLanes] of each group.
template <typename Image>
std::vector<Vec3f> collect(const std::vector<PilotGroup>& groups, const Image& image) {
  std::vector<Vec3f> result;
  for (const PilotGroup& group : groups) {
    const float* const values = image(group);
    for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
      if (!group.seen[lane]) continue;
      result.emplace_back(values[lane], values[kGroupLanes + lane], values[2 * kGroupLanes + lane]);
    }
  }
  return result;
}

/// PSNR under the worst light, for each octave.
std::array<double, kOctaves> worst_psnr(const std::vector<PilotGroup>& groups,
                                        const std::vector<CheckLight>& lights) {
  LightImages references;
  for (std::size_t light = 0; light < lights.size(); ++light) {
    references.push_back(collect(
        groups, [light](const PilotGroup& g) { return g.whole.data() + light * kRowLanes; }));
  }
  const std::vector<double> exposures = check_exposures(lights, references);
  std::array<double, kOctaves> result;
  parallel_for(kOctaves, [&](std::size_t octave) {
    double worst = 99;
    for (std::size_t light = 0; light < lights.size(); ++light) {
      const std::size_t at = (octave * lights.size() + light) * kRowLanes;
      const auto image =
          collect(groups, [at](const PilotGroup& g) { return g.by_step.data() + at; });
      worst = std::min(worst, display_psnr(image, references[light], exposures[light]));
    }
    result[octave] = worst;
  });
  return result;
}

}  // namespace

std::vector<std::size_t> sample_groups(const GroupSource& source, std::size_t count,
                                       std::uint64_t seed) {
  const std::size_t groups = source.layout().receiver_count() / kGroupLanes;
  std::vector<std::size_t> order(groups);
  for (std::size_t i = 0; i < groups; ++i) order[i] = i;
  Random random(seed, 0x9110);
  for (std::size_t i = groups; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  std::vector<std::size_t> result;
  for (const std::size_t group : order) {
    if (result.size() == count) break;
    if (source.has_receivers(group * kGroupLanes)) result.push_back(group * kGroupLanes);
  }
  return result;
}

float pilot_step(const GroupSource& source, const std::vector<std::size_t>& first_receivers,
                 const std::vector<CheckLight>& lights, double psnr_db) {
  std::vector<PilotGroup> groups(first_receivers.size());
  const std::vector<CubeLight> check_lights = coefficients_of(lights);
  parallel_for(groups.size(), [&](std::size_t i) {
    BakedGroup baked(source.cube_size());
    source.find_rows(first_receivers[i], baked);
    RIMLIGHT_CHECK(!baked.empty);
    for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
      groups[i].seen[lane] = baked.coverage[lane] > 0;
    }
    groups[i].whole.resize(lights.size() * kRowLanes);
    multiply_rows(baked.coefficients, check_lights, groups[i].whole.data());
    store_at_each_step(lights, source.typical_size(), baked, groups[i]);
  });
  const auto psnr = worst_psnr(groups, lights);
  const float size = source.typical_size();
  int octave = 0;
  while (octave < kOctaves - 1 && psnr[static_cast<std::size_t>(octave)] < psnr_db) ++octave;
  const auto found = static_cast<std::size_t>(octave);
  if (octave == 0 || psnr[found] < psnr_db || psnr[found] <= psnr[found - 1]) {
    return step_of(octave, size);
  }
  const double back = (psnr[found] - psnr_db) / (psnr[found] - psnr[found - 1]);
  return step_of(octave, size) * static_cast<float>(std::exp2(back));
}

}  // namespace rimlight
