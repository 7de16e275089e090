#include "core/import/imported_rows.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rimlight {

ImportedRows::ImportedRows(const PixelLayout& layout, int cube_size, std::vector<float> coverage,
                           FindRows find_rows)
    : layout_(layout),
      cube_size_(cube_size),
      coverage_(std::move(coverage)),
      find_rows_(std::move(find_rows)),
      typical_size_(measure_size()) {}

bool ImportedRows::has_receivers(std::size_t first_receiver) const {
  const auto first = coverage_.begin() + static_cast<std::ptrdiff_t>(first_receiver);
  return std::any_of(first, first + kGroupLanes, [](float share) { return share > 0; });
}

void ImportedRows::find_rows(std::size_t first_receiver, BakedGroup& group) const {
  group.empty = !has_receivers(first_receiver);
  const auto first = coverage_.begin() + static_cast<std::ptrdiff_t>(first_receiver);
  std::copy_n(first, kGroupLanes, group.coverage.begin());
  if (!group.empty) find_rows_(first_receiver, group.coefficients);
}

float ImportedRows::measure_size() const {
  constexpr std::size_t kGroups = 16;
  constexpr float kOfLargest = 1.0f / 16;
  const std::size_t groups = layout_.receiver_count() / kGroupLanes;
  GroupRows rows(cube_size_);
  float largest = 0;
  for (std::size_t i = 0; i < kGroups; ++i) {
    const std::size_t first_receiver = i * groups / kGroups * kGroupLanes;
    if (!has_receivers(first_receiver)) continue;
    find_rows_(first_receiver, rows);
    for (const float value : rows.values) largest = std::max(largest, std::abs(value));
  }
  return largest > 0 ? kOfLargest * largest : 1.0f;
}

}  // namespace rimlight
