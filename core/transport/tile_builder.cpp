#include "core/transport/tile_builder.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

#include "core/base/check.h"
#include "core/transport/transport.h"

namespace rimlight {
namespace {

/// Whether any of a block's numbers rounds to a step or more. NaNs count, so that they are found.
bool rounds_to_something(const float* block, float half_step) {
  bool any = false;
  for (std::size_t i = 0; i < kBlockReceivers; ++i) any |= !(std::abs(block[i]) < half_step);
  return any;
}

}  // namespace

TileBuilder::TileBuilder(std::size_t column_count, const StorageStep& storage)
    : column_count_(column_count), storage_(storage) {
  RIMLIGHT_CHECK(column_count > 0 && column_count <= TransportView::kMostColumns);
  RIMLIGHT_CHECK(storage.step > 0 && std::isfinite(storage.step));
  RIMLIGHT_CHECK(storage.least_energy >= 0);
}

void TileBuilder::add_group(std::size_t group, std::span<const float> planes) {
  RIMLIGHT_CHECK(group < kGroups);
  RIMLIGHT_CHECK_EQ(planes.size(), column_count_ * kGroupFloats);
  Group& kept = groups_[group];
  RIMLIGHT_CHECK(kept.columns.empty());
  const float half_step = 0.5f * storage_.step;
  const float to_steps = 1 / storage_.step;
  for (std::size_t column = 0; column < column_count_; ++column) {
    const float* block = planes.data() + column * kGroupFloats;
    std::uint32_t mask = 0;
    for (std::size_t i = 0; i < kPlanes * kGroupBlocks; ++i, block += kBlockReceivers) {
      if (!rounds_to_something(block, half_step)) continue;
      mask |= 1u << i;
      for (std::size_t k = 0; k < kBlockReceivers; ++k) {
        kept.values.push_back(block[k] * to_steps);
        RIMLIGHT_CHECK(std::isfinite(kept.values.back()));
      }
    }
    if (mask != 0) kept.columns.push_back({static_cast<std::uint32_t>(column), mask});
  }
  kept.columns.shrink_to_fit();
  kept.values.shrink_to_fit();
}

TileTransport TileBuilder::assemble() const {
  TileTransport tile;
  tile.column_step.assign(column_count_, storage_.step);
  tile.run_offset.push_back(0);
  std::array<std::size_t, kGroups> next_column{}, next_value{};
  RunBuilder builder(storage_.least_energy);
  RunBlock block;
  for (std::size_t column = 0; column < column_count_; ++column) {
    for (std::size_t g = 0; g < kGroups; ++g) {
      const Group& group = groups_[g];
      if (next_column[g] == group.columns.size()) continue;
      if (group.columns[next_column[g]].column != column) continue;
      for (auto mask = group.columns[next_column[g]++].block_mask; mask != 0; mask &= mask - 1) {
        const auto bit = static_cast<std::size_t>(std::countr_zero(mask));
        block.plane = bit / kGroupBlocks;
        block.index = static_cast<std::uint16_t>(g * kGroupBlocks + bit % kGroupBlocks);
        const auto* const from = group.values.data() + next_value[g];
        std::copy_n(from, kBlockReceivers, block.value.begin());
        builder.add(block);
        next_value[g] += kBlockReceivers;
      }
    }
    builder.finish(tile.runs);
    tile.run_offset.push_back(static_cast<std::uint32_t>(tile.runs.size()));
  }
  return tile;
}

}  // namespace rimlight
