#include "core/relight/update_plan.h"

#include <bit>

namespace rimlight {

void append_deltas(std::size_t column, const std::array<Vec3f, kLayers>& deltas, LayerSet layers,
                   std::vector<ColumnDelta>& columns) {
  while (layers != 0) {
    const Vec3f delta = deltas[static_cast<std::size_t>(std::countr_zero(layers))];
    LayerSet same = 0;
    for (std::size_t layer = 0; layer < kLayers; ++layer) {
      const bool is_same = (layers >> layer & 1) != 0 && deltas[layer] == delta;
      if (is_same) same |= static_cast<LayerSet>(1 << layer);
    }
    // Not even itself: never in a plan made of finite lights.
    if (same == 0) same = layers;
    if (delta != Vec3f{}) columns.push_back({static_cast<std::uint32_t>(column), delta, same});
    layers &= static_cast<LayerSet>(~same);
  }
}

std::size_t UpdatePlan::column_count() const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    count += i == 0 || columns[i].column != columns[i - 1].column;
  }
  return count;
}

}  // namespace rimlight
