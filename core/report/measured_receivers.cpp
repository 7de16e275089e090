#include "core/report/measured_receivers.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

constexpr std::size_t kGroupReceivers = PixelLayout::kGroupReceivers;
constexpr std::size_t kSampledGroups = 128;
constexpr std::uint64_t kSampleSeed = 0x5ef;

bool is_covered(const Bake& bake, std::size_t receiver) {
  const PixelLayout& pixels = bake.manifest().pixels;
  const auto [x, y] = pixels.pixel(receiver);
  if (x >= pixels.width || y >= pixels.height) return false;
  return bake.coverage()[static_cast<std::size_t>(y) * static_cast<std::size_t>(pixels.width) +
                         static_cast<std::size_t>(x)] > 0;
}

bool has_covered(const Bake& bake, std::size_t first_receiver) {
  for (std::size_t i = 0; i < kGroupReceivers; ++i) {
    if (is_covered(bake, first_receiver + i)) return true;
  }
  return false;
}

/// First receivers of sampled groups, ascending.
std::vector<std::uint64_t> sample_groups(const Bake& bake) {
  std::vector<std::uint64_t> groups;
  const std::size_t count = bake.manifest().pixels.receiver_count();
  for (std::size_t first = 0; first < count; first += kGroupReceivers) {
    if (has_covered(bake, first)) groups.push_back(first);
  }
  Random random(kSampleSeed);
  for (std::size_t i = groups.size(); i > 1; --i) std::swap(groups[i - 1], groups[random.below(i)]);
  groups.resize(std::min(groups.size(), kSampledGroups));
  std::sort(groups.begin(), groups.end());
  return groups;
}

}  // namespace

MeasuredReceivers::MeasuredReceivers(const Bake& bake) : rows_(ReferenceRows::open(bake)) {
  std::vector<std::uint64_t> groups;
  if (rows_) {
    groups.assign(rows_->groups().begin(), rows_->groups().end());
  } else {
    groups = sample_groups(bake);
  }
  for (std::size_t group = 0; group < groups.size(); ++group) {
    for (std::size_t i = 0; i < kGroupReceivers; ++i) {
      const std::size_t receiver = groups[group] + i;
      if (!is_covered(bake, receiver)) continue;
      const bool same_tile =
          !receivers_.empty() && receivers_.back() / kTileReceivers == receiver / kTileReceivers;
      if (!same_tile) first_.push_back(receivers_.size());
      receivers_.push_back(receiver);
      row_.push_back(group * kGroupReceivers + i);
    }
  }
  first_.push_back(receivers_.size());
}

void MeasuredReceivers::gather(const Relighter& relighter, std::vector<Vec3f>& image) const {
  image.resize(count());
  parallel_for(first_.size() - 1, [&](std::size_t part) {
    alignas(64) std::array<float, kTileFloats> radiance;
    relighter.find_radiance(receivers_[first_[part]] / kTileReceivers, radiance);
    for (std::size_t i = first_[part]; i < first_[part + 1]; ++i) {
      const std::size_t place = receivers_[i] % kTileReceivers;
      const float* const lane =
          radiance.data() + place / kBlockReceivers * kBlockFloats + place % kBlockReceivers;
      image[i] = {lane[0], lane[kBlockReceivers], lane[2 * kBlockReceivers]};
    }
  });
}

std::vector<std::vector<Vec3f>> MeasuredReceivers::reference(
    std::span<const CubeLight> lights) const {
  RIMLIGHT_CHECK(has_rows());
  const auto whole = rows_->multiply(lights);
  std::vector<std::vector<Vec3f>> result;
  for (const std::vector<Vec3f>& image : whole) result.push_back(select(image));
  return result;
}

std::vector<Vec3f> MeasuredReceivers::select(const std::vector<Vec3f>& of_rows) const {
  std::vector<Vec3f> result;
  for (const std::size_t row : row_) result.push_back(of_rows[row]);
  return result;
}

}  // namespace rimlight
