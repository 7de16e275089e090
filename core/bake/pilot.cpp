#include "core/bake/pilot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include "core/base/parallel.h"
#include "core/image/metrics.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

constexpr int kLevels = 80;         // half octaves
constexpr float kLowestLog2 = -40;  // level 0 takes everything below

int level_of(float magnitude) {
  if (!(magnitude > 0)) return 0;
  const float level = 2 * (std::log2(magnitude) - kLowestLog2);
  return static_cast<int>(std::clamp(level, 0.0f, static_cast<float>(kLevels - 1)));
}

double threshold_of(int level) { return std::exp2(kLowestLog2 + 0.5 * level); }

/// A group's images under each light, by level of the blocks that they come from.
struct PilotGroup {
  std::vector<float> by_level;  // [level][light][kRowLanes]
  AlignedVector<float> whole;   // [light][kRowLanes]
  std::array<bool, kGroupLanes> seen{};
};

void split_by_level(const BakedGroup& group, const std::vector<CheckLight>& lights,
                    PilotGroup& result) {
  const std::size_t columns = group.coefficients.values.size() / kRowLanes;
  result.by_level.assign(kLevels * lights.size() * kRowLanes, 0.0f);
  for (std::size_t column = 0; column < columns; ++column) {
    const float* const row = group.coefficients.row(column);
    for (std::size_t block = 0; block < kGroupLanes; block += kBlockReceivers) {
      float largest = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < kBlockReceivers; ++i) {
          largest = std::max(largest, std::abs(row[c * kGroupLanes + block + i]));
        }
      }
      if (largest == 0) continue;
      const auto level = static_cast<std::size_t>(level_of(largest));
      for (std::size_t light = 0; light < lights.size(); ++light) {
        const Vec3f value = lights[light].coefficients.at(column);
        float* const sum =
            result.by_level.data() + (level * lights.size() + light) * kRowLanes + block;
        for (std::size_t c = 0; c < 3; ++c) {
          for (std::size_t i = 0; i < kBlockReceivers; ++i) {
            sum[c * kGroupLanes + i] +=
                value[static_cast<int>(c)] * row[c * kGroupLanes + block + i];
          }
        }
      }
    }
  }
}

/// The pilot's receivers under one light.
std::vector<Vec3f> collect(const std::vector<PilotGroup>& groups, std::size_t light,
                           const std::function<const float*(const PilotGroup&)>& image) {
  std::vector<Vec3f> result;
  for (const PilotGroup& group : groups) {
    const float* const values = image(group) + light * kRowLanes;
    for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
      if (!group.seen[lane]) continue;
      result.emplace_back(values[lane], values[kGroupLanes + lane], values[2 * kGroupLanes + lane]);
    }
  }
  return result;
}

}  // namespace

std::vector<std::size_t> sample_groups(const GroupBaker& baker, std::size_t count,
                                       std::uint64_t seed) {
  const std::size_t groups = baker.layout().receiver_count() / kGroupLanes;
  std::vector<std::size_t> order(groups);
  for (std::size_t i = 0; i < groups; ++i) order[i] = i;
  Random random(seed, 0x9110);
  for (std::size_t i = groups; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  std::vector<std::size_t> result;
  for (const std::size_t group : order) {
    if (result.size() == count) break;
    if (baker.sees_geometry(group * kGroupLanes)) result.push_back(group * kGroupLanes);
  }
  return result;
}

double pilot_threshold(const GroupBaker& baker, const std::vector<std::size_t>& first_receivers,
                       const std::vector<CheckLight>& lights, double psnr_db) {
  std::vector<PilotGroup> groups(first_receivers.size());
  parallel_for(groups.size(), [&](std::size_t i) {
    BakedGroup baked(baker.haar().size(), lights.size());
    baker.bake(first_receivers[i], baked);
    for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
      groups[i].seen[lane] = baked.coverage[lane] > 0;
    }
    groups[i].whole = baked.check_images;
    split_by_level(baked, lights, groups[i]);
  });
  LightImages references;
  for (std::size_t light = 0; light < lights.size(); ++light) {
    references.push_back(
        collect(groups, light, [](const PilotGroup& g) { return g.whole.data(); }));
  }
  const std::vector<double> scales = check_exposures(lights, references);
  // From the largest blocks down: what is left out shrinks until every light is good enough.
  const std::size_t stride = lights.size() * kRowLanes;
  for (int level = kLevels - 1; level >= 0; --level) {
    const auto at = static_cast<std::size_t>(level) * stride;
    if (level + 1 < kLevels) {
      for (PilotGroup& group : groups) {
        for (std::size_t i = 0; i < stride; ++i)
          group.by_level[at + i] += group.by_level[at + stride + i];
      }
    }
    bool good = true;
    for (std::size_t light = 0; good && light < lights.size(); ++light) {
      const auto image =
          collect(groups, light, [at](const PilotGroup& g) { return g.by_level.data() + at; });
      good = display_psnr(image, references[light], scales[light]) >= psnr_db;
    }
    if (good) return threshold_of(level);
  }
  return 0;
}

}  // namespace rimlight
