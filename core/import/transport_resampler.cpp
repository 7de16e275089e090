#include "core/import/transport_resampler.h"

#include <algorithm>

#include "core/bake/lane_kernel.h"
#include "core/base/check.h"

namespace rimlight {

TransportResampler::TransportResampler(const DirectionCells& cells,
                                       std::span<const double> energy) {
  RIMLIGHT_CHECK_EQ(energy.size(), cells.direction_count());
  first_share_.push_back(0);
  for (std::size_t direction = 0; direction < energy.size(); ++direction) {
    const double area = cells.solid_angle(direction);
    RIMLIGHT_CHECK(area > 0 && energy[direction] >= 0);
    for (const DirectionCells::Share& share : cells.shares(direction)) {
      shares_.push_back(
          {share.texel, static_cast<float>(share.solid_angle / area * energy[direction])});
    }
    first_share_.push_back(shares_.size());
  }
}

void TransportResampler::resample(std::span<const float> rows, GroupRows& texels) const {
  RIMLIGHT_CHECK_EQ(rows.size(), direction_count() * kRowLanes);
  std::fill(texels.values.begin(), texels.values.end(), 0.0f);
  for (std::size_t direction = 0; direction < direction_count(); ++direction) {
    const float* const row = rows.data() + direction * kRowLanes;
    for (std::size_t i = first_share_[direction]; i < first_share_[direction + 1]; ++i) {
      add_weighted_lanes(row, Vec3f::filled(shares_[i].weight), texels.row(shares_[i].texel));
    }
  }
}

std::vector<Vec3f> TransportResampler::light_of_directions(const CubeLight& light) const {
  std::vector<Vec3f> result;
  for (std::size_t direction = 0; direction < direction_count(); ++direction) {
    Vec3d sum;
    for (std::size_t i = first_share_[direction]; i < first_share_[direction + 1]; ++i) {
      sum += Vec3d(light.at(shares_[i].texel)) * static_cast<double>(shares_[i].weight);
    }
    result.emplace_back(sum);
  }
  return result;
}

}  // namespace rimlight
