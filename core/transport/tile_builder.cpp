#include "core/transport/tile_builder.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

#include "core/base/check.h"

namespace rimlight {
namespace {

constexpr std::size_t kGroupReceivers = PixelLayout::kGroupReceivers;
constexpr std::size_t kRow = 3 * kGroupReceivers;

/// Magnitudes of floats order as their bits do, infinities and NaNs above all numbers; and a
/// maximum of integers vectorises.
std::int32_t magnitude_bits(float value) { return std::bit_cast<std::int32_t>(value) & 0x7fffffff; }

/// Of the bits of a largest |m|: below FLT_MIN it is zero, so that flushed denormals change
/// nothing.
float magnitude(std::int32_t bits) {
  RIMLIGHT_CHECK(bits < 0x7f800000);
  return bits < 0x00800000 ? 0.0f : std::bit_cast<float>(bits);
}

/// The largest |m| of each of the eight blocks of a column's rows [channel][64].
std::array<float, TileBuilder::kGroupBlocks> largest_magnitudes(const float* rows) {
  std::array<std::int32_t, kGroupReceivers> largest{};
  for (std::size_t channel = 0; channel < 3; ++channel) {
    for (std::size_t i = 0; i < kGroupReceivers; ++i) {
      largest[i] = std::max(largest[i], magnitude_bits(rows[channel * kGroupReceivers + i]));
    }
  }
  std::array<float, TileBuilder::kGroupBlocks> result;
  for (std::size_t block = 0; block < result.size(); ++block) {
    const auto first = largest.begin() + static_cast<std::ptrdiff_t>(block * kBlockReceivers);
    result[block] = magnitude(*std::max_element(first, first + kBlockReceivers));
  }
  return result;
}

/// A run's blocks, gathered from the groups in the order of their places.
struct Run {
  std::vector<std::uint16_t> block_index;
  std::vector<const float*> values;  // each [3][8]
};

void append_run(const Run& run, TileTransport& tile) {
  std::int32_t largest = 0;
  for (const float* values : run.values) {
    for (std::size_t i = 0; i < kBlockFloats; ++i) {
      largest = std::max(largest, magnitude_bits(values[i]));
    }
  }
  const float scale = magnitude(largest);
  tile.column_scale.push_back(scale);
  for (std::size_t i = 0; i < run.values.size(); ++i) {
    std::array<Half, kBlockFloats> halves;
    std::transform(run.values[i], run.values[i] + kBlockFloats, halves.begin(),
                   [scale](float value) { return to_half(value / scale); });
    const auto is_zero = [](Half half) { return (half & 0x7fff) == 0; };
    if (std::ranges::all_of(halves, is_zero)) continue;
    tile.block_index.push_back(run.block_index[i]);
    tile.value.insert(tile.value.end(), halves.begin(), halves.end());
  }
  tile.column_offset.push_back(static_cast<std::uint32_t>(tile.block_index.size()));
}

}  // namespace

TileBuilder::TileBuilder(std::span<const float> weights, float threshold)
    : weights_(weights.begin(), weights.end()), threshold_(threshold) {
  RIMLIGHT_CHECK(!weights.empty() && weights.size() <= TransportView::kMostColumns);
  RIMLIGHT_CHECK(threshold >= 0);
  RIMLIGHT_CHECK(std::ranges::all_of(weights, [](float w) { return w >= 0 && std::isfinite(w); }));
}

void TileBuilder::add_group(std::size_t group, std::span<const float> rows) {
  RIMLIGHT_CHECK(group < kGroups);
  RIMLIGHT_CHECK_EQ(rows.size(), column_count() * kRow);
  Group& kept = groups_[group];
  RIMLIGHT_CHECK(kept.columns.empty());
  for (std::size_t column = 0; column < column_count(); ++column) {
    const float* const row = rows.data() + column * kRow;
    const auto largest = largest_magnitudes(row);
    std::uint32_t mask = 0;
    for (std::size_t block = 0; block < kGroupBlocks; ++block) {
      if (!(largest[block] * weights_[column] > threshold_)) continue;
      mask |= 1u << block;
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const float* const first = row + channel * kGroupReceivers + block * kBlockReceivers;
        kept.values.insert(kept.values.end(), first, first + kBlockReceivers);
      }
    }
    if (mask != 0) kept.columns.push_back({static_cast<std::uint32_t>(column), mask});
  }
  kept.columns.shrink_to_fit();
  kept.values.shrink_to_fit();
}

TileTransport TileBuilder::assemble() const {
  TileTransport tile;
  tile.column_offset.push_back(0);
  std::array<std::size_t, kGroups> next_column{}, next_value{};
  Run run;
  for (std::size_t column = 0; column < column_count(); ++column) {
    run.block_index.clear();
    run.values.clear();
    for (std::size_t g = 0; g < kGroups; ++g) {
      const Group& group = groups_[g];
      if (next_column[g] == group.columns.size()) continue;
      if (group.columns[next_column[g]].column != column) continue;
      for (auto mask = group.columns[next_column[g]++].block_mask; mask != 0; mask &= mask - 1) {
        const auto block = static_cast<std::size_t>(std::countr_zero(mask));
        run.block_index.push_back(static_cast<std::uint16_t>(g * kGroupBlocks + block));
        run.values.push_back(group.values.data() + next_value[g]);
        next_value[g] += kBlockFloats;
      }
    }
    append_run(run, tile);
  }
  return tile;
}

}  // namespace rimlight
