#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/transport/receivers.h"
#include "core/transport/tile_transport.h"

namespace rimlight {

/// Compresses one tile: takes its 64 groups of 64 receivers one by one, keeps the blocks that
/// matter, and puts them together column by column. Memory: a group's dense rows belong to the
/// caller; here lies what is kept, as floats (100 bytes a block).
/// Any thread may add any group; groups of different places may be added at once. The result does
/// not depend on the order.
class TileBuilder {
 public:
  static constexpr std::size_t kGroups = kTileReceivers / PixelLayout::kGroupReceivers;
  static constexpr std::size_t kGroupBlocks = PixelLayout::kGroupReceivers / kBlockReceivers;

  /// Keeps a block when its largest |m| over 3 × 8 entries, times its column's weight, is above
  /// `threshold`; magnitudes below FLT_MIN are zero. `weights` [columns] ≥ 0 are copied.
  TileBuilder(std::span<const float> weights, float threshold);

  std::size_t column_count() const { return weights_.size(); }

  /// The receivers 64 · group … of the tile: rows [column][channel][64], receivers in order, so
  /// that 8b … 8b + 7 are the group's block b. Finite, else CheckFailure. Each group at most once.
  void add_group(std::size_t group, std::span<const float> rows);

  /// Runs by column; a run's scale is its largest |m|, its values m / scale rounded to the nearest
  /// half, ties to even: within 2⁻¹¹ of each value's own size, or 2⁻²⁵ of the scale. Blocks whose
  /// halves are all zero are left out. Groups that were not added are zero.
  TileTransport assemble() const;

 private:
  /// The kept blocks of one group, by column, then block.
  struct Group {
    struct Column {
      std::uint32_t column;
      std::uint32_t block_mask;
    };
    std::vector<Column> columns;
    std::vector<float> values;  // [kept block][3][8]
  };

  std::vector<float> weights_;
  float threshold_;
  std::array<Group, kGroups> groups_;
};

}  // namespace rimlight
