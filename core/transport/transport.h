#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "core/base/half.h"
#include "core/transport/receivers.h"

namespace rimlight {

/// One column's run in one tile: the blocks where it is not zero.
///   block_index  [n] strictly ascending, < kTileBlocks
///   values       [n][3][8]; radiance = value · scale. Finite; 16-byte aligned
struct ColumnRun {
  std::span<const std::uint16_t> block_index;
  const Half* values = nullptr;
  float scale = 0;
};

/// M: baked transport, receivers × columns, sparse by blocks of 8 receivers, column runs in tiles
/// of 4,096 receivers. A view of memory that its owner (a Bake, or a Transport of tile_transport.h)
/// keeps alive. Any thread.
class TransportView {
 public:
  struct Arrays {
    std::size_t tile_count = 0;
    std::size_t column_count = 0;
    /// [tile_count + 1] into block_index and values
    std::span<const std::uint64_t> tile_first_block;
    /// [tile_count][column_count + 1], counted in blocks from the tile's first
    std::span<const std::uint32_t> column_offset;
    std::span<const float> column_scale;         // [tile_count][column_count], finite, ≥ 0
    std::span<const std::uint16_t> block_index;  // [blocks]
    std::span<const Half> values;                // [blocks][3][8], finite
  };
  static constexpr std::size_t kMostColumns = std::size_t{1} << 24;

  TransportView() = default;
  /// Checks every size, offset, index, scale and value (exponent 31 is refused), so that kernels
  /// need not look: throws Error naming `source` and the array. One parallel pass over all arrays.
  TransportView(const Arrays& arrays, const std::string& source);

  std::size_t tile_count() const { return arrays_.tile_count; }
  std::size_t column_count() const { return arrays_.column_count; }
  std::size_t block_count() const { return arrays_.block_index.size(); }
  const Arrays& arrays() const { return arrays_; }

  std::size_t tile_block_count(std::size_t tile) const {
    return arrays_.tile_first_block[tile + 1] - arrays_.tile_first_block[tile];
  }
  ColumnRun run(std::size_t tile, std::size_t column) const {
    const std::uint32_t* const offset =
        arrays_.column_offset.data() + tile * (arrays_.column_count + 1) + column;
    const std::size_t first = arrays_.tile_first_block[tile] + offset[0];
    return {arrays_.block_index.subspan(first, offset[1] - offset[0]),
            arrays_.values.data() + first * kBlockFloats,
            arrays_.column_scale[tile * arrays_.column_count + column]};
  }

 private:
  Arrays arrays_;
};

}  // namespace rimlight
