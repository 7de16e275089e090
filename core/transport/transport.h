#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/transport/column_run.h"
#include "core/transport/receivers.h"

namespace rimlight {

/// M: baked transport, receivers × columns, sparse by blocks of 8 numbers, column runs in tiles of
/// 4,096 receivers. Rows are stored as planes (receiver_planes.h); numbers as multiples of their
/// column's step (column_run.h). A view of memory that its owner (a Bake, or a Transport of
/// tile_transport.h) keeps alive. Any thread.
class TransportView {
 public:
  struct Arrays {
    std::size_t tile_count = 0;
    std::size_t column_count = 0;
    std::span<const float> column_step;  // [column_count], finite, ≥ 0
    /// [tile_count + 1] into runs
    std::span<const std::uint64_t> tile_first_word;
    /// [tile_count][column_count + 1], counted in words from the tile's first
    std::span<const std::uint32_t> run_offset;
    std::span<const std::uint64_t> runs;  // [words], column runs one after another
  };
  static constexpr std::size_t kMostColumns = std::size_t{1} << 24;

  TransportView() = default;
  /// Checks every size, offset, step and run, so that kernels need not look: throws Error naming
  /// `source` and the array. One parallel pass over all arrays.
  TransportView(const Arrays& arrays, const std::string& source);

  std::size_t tile_count() const { return arrays_.tile_count; }
  std::size_t column_count() const { return arrays_.column_count; }
  /// Bytes of all runs.
  std::size_t byte_count() const { return arrays_.runs.size_bytes(); }
  const Arrays& arrays() const { return arrays_; }

  /// What a unit in the column's runs stands for.
  float step(std::size_t column) const { return arrays_.column_step[column]; }
  ColumnRun run(std::size_t tile, std::size_t column) const {
    const std::uint32_t* const offset =
        arrays_.run_offset.data() + tile * (arrays_.column_count + 1) + column;
    return ColumnRun(
        arrays_.runs.subspan(arrays_.tile_first_word[tile] + offset[0], offset[1] - offset[0]));
  }

 private:
  Arrays arrays_;
};

/// What adding a column reads: bytes of its runs in all tiles, at most 2³² − 1. [columns].
std::vector<std::uint32_t> count_column_bytes(const TransportView& transport);

/// What adding a layer of a column by itself takes, in all tiles; at most 2³² − 1.
struct PartSize {
  std::uint32_t bytes = 0;   // read, the runs' counts included
  std::uint32_t blocks = 0;  // added
  std::uint32_t runs = 0;    // that have any
};
/// [part].
std::vector<PartSize> measure_parts(const TransportView& transport);

}  // namespace rimlight
