#include "core/import/import_pilot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/parallel.h"
#include "core/image/metrics.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

constexpr std::size_t kMostGroups = 32;
constexpr std::size_t kFewestGroups = 4;
constexpr std::size_t kSampleBytes = std::size_t{512} << 20;
constexpr std::uint64_t kSeed = 0x1390;
constexpr int kHalfOctaves = 80;  // below the largest block
constexpr std::size_t kBlocks = kGroupLanes / kBlockReceivers;

/// One group of the sample: dense rows, and the largest |m| of each block of each column.
struct SampleGroup {
  GroupRows rows;
  std::vector<float> largest;  // [column][block]
  std::array<bool, kGroupLanes> covered{};

  explicit SampleGroup(int cube_size) : rows(cube_size) {}
};

std::array<bool, kGroupLanes> covered_lanes(const ImportedTransport& transport,
                                            std::size_t first_receiver) {
  const PixelLayout& pixels = transport.manifest.pixels;
  std::array<bool, kGroupLanes> covered{};
  for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
    const auto [x, y] = pixels.pixel(first_receiver + lane);
    covered[lane] =
        x < pixels.width && y < pixels.height &&
        transport.coverage[static_cast<std::size_t>(y) * static_cast<std::size_t>(pixels.width) +
                           static_cast<std::size_t>(x)] > 0;
  }
  return covered;
}

/// First receivers of a seeded sample of the groups that have a covered pixel.
std::vector<std::size_t> sample_groups(const ImportedTransport& transport, std::size_t most) {
  const std::size_t groups = transport.manifest.pixels.receiver_count() / kGroupLanes;
  std::vector<std::size_t> order(groups);
  for (std::size_t i = 0; i < groups; ++i) order[i] = i * kGroupLanes;
  Random random(kSeed);
  for (std::size_t i = groups; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  std::vector<std::size_t> sample;
  for (const std::size_t first : order) {
    if (sample.size() == most) break;
    const auto covered = covered_lanes(transport, first);
    if (std::find(covered.begin(), covered.end(), true) != covered.end()) sample.push_back(first);
  }
  return sample;
}

void find_largest(SampleGroup& group) {
  const std::size_t columns = group.rows.values.size() / kRowLanes;
  group.largest.assign(columns * kBlocks, 0.0f);
  for (std::size_t column = 0; column < columns; ++column) {
    const float* const row = group.rows.row(column);
    for (std::size_t i = 0; i < kRowLanes; ++i) {
      float& largest = group.largest[column * kBlocks + i % kGroupLanes / kBlockReceivers];
      largest = std::max(largest, std::abs(row[i]));
    }
  }
}

/// The group's covered pixels under a light, from the blocks above a threshold; all with −1.
void add_image(const SampleGroup& group, const CubeLight& light, float threshold,
               std::vector<Vec3f>& image) {
  std::array<float, kRowLanes> sum{};
  for (std::size_t column = 0; column < light.count(); ++column) {
    const Vec3f value = light.at(column);
    if (value == Vec3f{}) continue;
    const float* const row = group.rows.row(column);
    for (std::size_t block = 0; block < kBlocks; ++block) {
      if (!(group.largest[column * kBlocks + block] > threshold)) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t at = c * kGroupLanes + block * kBlockReceivers;
        for (std::size_t i = at; i < at + kBlockReceivers; ++i) {
          sum[i] += value[static_cast<int>(c)] * row[i];
        }
      }
    }
  }
  for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
    if (!group.covered[lane]) continue;
    image.emplace_back(sum[lane], sum[kGroupLanes + lane], sum[2 * kGroupLanes + lane]);
  }
}

LightImages images_above(const std::vector<SampleGroup>& groups,
                         const std::vector<CheckLight>& lights, float threshold) {
  LightImages images(lights.size());
  parallel_for(lights.size(), [&](std::size_t light) {
    for (const SampleGroup& group : groups) {
      add_image(group, lights[light].coefficients, threshold, images[light]);
    }
  });
  return images;
}

std::vector<SampleGroup> read_sample(const ImportedTransport& transport) {
  const int cube_size = transport.manifest.cube_size;
  const std::size_t group_bytes = cube::texel_count(cube_size) * kRowLanes * sizeof(float);
  const auto first_receivers =
      sample_groups(transport, std::clamp(kSampleBytes / group_bytes, kFewestGroups, kMostGroups));
  std::vector<SampleGroup> groups(first_receivers.size(), SampleGroup(cube_size));
  parallel_for(groups.size(), [&](std::size_t i) {
    groups[i].covered = covered_lanes(transport, first_receivers[i]);
    transport.rows(first_receivers[i], groups[i].rows);
    find_largest(groups[i]);
  });
  return groups;
}

}  // namespace

double import_threshold(const ImportedTransport& transport, const std::vector<CheckLight>& lights,
                        double psnr_db) {
  const std::vector<SampleGroup> groups = read_sample(transport);
  float largest = 1e-30f;
  for (const SampleGroup& group : groups) {
    largest = std::max(largest, *std::max_element(group.largest.begin(), group.largest.end()));
  }
  const LightImages references = images_above(groups, lights, -1);
  const std::vector<double> exposures = check_exposures(lights, references);
  const auto threshold_of = [largest](int step) {
    return std::max(largest * std::exp2(-0.5f * static_cast<float>(step)), 1e-37f);
  };
  const auto good = [&](int step) {
    const LightImages images = images_above(groups, lights, threshold_of(step));
    for (std::size_t light = 0; light < lights.size(); ++light) {
      if (display_psnr(images[light], references[light], exposures[light]) < psnr_db) return false;
    }
    return true;
  };
  int fails = -1;
  int holds = kHalfOctaves;
  while (holds - fails > 1) {
    const int middle = (holds + fails) / 2;
    (good(middle) ? holds : fails) = middle;
  }
  return static_cast<double>(threshold_of(holds));
}

}  // namespace rimlight
