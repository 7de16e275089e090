#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/transport/receiver_planes.h"
#include "core/transport/receivers.h"
#include "core/transport/tile_transport.h"

namespace rimlight {

/// How finely transport is stored: what compression is chosen by.
struct StorageStep {
  float step = 0;          // of all columns: numbers are rounded to multiples of it
  float least_energy = 3;  // a block whose Σ (rounded value / step)² is below is left out

  friend bool operator==(const StorageStep&, const StorageStep&) = default;
};

/// Compresses one tile: takes its 64 groups of 64 receivers one by one as planes, keeps the blocks
/// that matter, and puts them together column by column. Memory: a group's dense rows belong to the
/// caller; here lies what is kept, as floats (32 bytes a block).
/// Any thread may add any group; groups of different places may be added at once. The result does
/// not depend on the order.
class TileBuilder {
 public:
  static constexpr std::size_t kGroups = kTileReceivers / PixelLayout::kGroupReceivers;
  static constexpr std::size_t kGroupBlocks = PixelLayout::kGroupReceivers / kBlockReceivers;

  /// 1 … TransportView::kMostColumns columns; a finite step above 0.
  TileBuilder(std::size_t column_count, const StorageStep& storage);

  std::size_t column_count() const { return column_count_; }

  /// The 64 receivers of one group: planes [column][plane][64] as to_planes() makes them. Finite,
  /// else CheckFailure. Each group at most once.
  void add_group(std::size_t group, std::span<const float> planes);

  /// Groups that were not added are zero. A number is within half a step and relative 2⁻²³ of
  /// what it was made of (together: floats count the steps); or its block was left out.
  TileTransport assemble() const;

 private:
  /// The blocks of one group that may be kept, by column, then plane, then block.
  struct Group {
    struct Column {
      std::uint32_t column;
      std::uint32_t block_mask;  // bit plane · 8 + block
    };
    std::vector<Column> columns;
    std::vector<float> values;  // [block][8], in steps
  };

  std::size_t column_count_;
  StorageStep storage_;
  std::array<Group, kGroups> groups_;
};

}  // namespace rimlight
