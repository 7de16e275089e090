#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "core/math/vec.h"
#include "core/transport/receivers.h"

namespace rimlight {

/// One column's run in one tile: the blocks where it is not zero.
///   block_index  [n] strictly ascending, < kTileBlocks
///   values       [n][3][8] IEEE half floats; radiance = value · scale. Finite: exponent 31 is
///   refused
///                on load. 16-byte aligned
struct ColumnRun {
  std::span<const std::uint16_t> block_index;
  const std::uint16_t* values = nullptr;
  float scale = 0;
};

/// M: baked transport, receivers × columns, sparse by blocks of 8 receivers, column runs in tiles
/// of 4,096 receivers. A view of memory that its owner (a bake's tensors, or a TransportBuilder)
/// keeps alive. Any thread.
class TransportView {
 public:
  struct Arrays {
    std::size_t tile_count = 0;
    std::size_t column_count = 0;
    std::span<const std::uint64_t>
        tile_first_block;  // [tile_count + 1] into block_index and values
    std::span<const std::uint32_t>
        column_offset;                    // [tile_count][column_count + 1], blocks in the tile
    std::span<const float> column_scale;  // [tile_count][column_count]
    std::span<const std::uint16_t> block_index;  // [blocks]
    std::span<const std::uint16_t> values;       // [blocks][3][8] halves
  };

  TransportView() = default;
  /// Checks every offset and index (not the values): throws Error naming `source` when they are not
  /// as promised, so that kernels need not look. Costs one pass over offsets and indices.
  TransportView(const Arrays& arrays, const std::string& source);

  std::size_t tile_count() const { return arrays_.tile_count; }
  std::size_t column_count() const { return arrays_.column_count; }
  std::size_t block_count() const { return arrays_.block_index.size(); }
  std::size_t tile_block_count(std::size_t tile) const;
  ColumnRun run(std::size_t tile, std::size_t column) const;

 private:
  Arrays arrays_;
};

}  // namespace rimlight
