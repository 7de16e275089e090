#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/transport/transport.h"

namespace rimlight {

/// The transport of one tile of 4,096 receivers, in column order: what TransportView holds a tile.
struct TileTransport {
  std::vector<float> column_step;         // [columns], the same for all tiles of a bake
  std::vector<std::uint32_t> run_offset;  // [columns + 1], in words, from 0
  std::vector<std::uint64_t> runs;        // [words]

  std::size_t column_count() const { return column_step.size(); }
  ColumnRun run(std::size_t column) const {
    return ColumnRun(
        std::span(runs).subspan(run_offset[column], run_offset[column + 1] - run_offset[column]));
  }
  friend bool operator==(const TileTransport&, const TileTransport&) = default;
};

/// Leaves out each block whose Σ value² (in steps²) is below `least_energy`, as TileBuilder does:
/// the result is what a builder of that least energy would have made.
TileTransport prune(const TileTransport& tile, float least_energy);

/// Transport in memory: owns the arrays of its view. Movable; immutable; any thread.
class Transport {
 public:
  /// All tiles have the same steps, else CheckFailure. Checks what TransportView does.
  explicit Transport(std::span<const TileTransport> tiles);
  Transport(Transport&&) noexcept = default;
  Transport& operator=(Transport&&) noexcept = default;

  const TransportView& view() const { return view_; }

 private:
  std::vector<float> column_step_;
  std::vector<std::uint64_t> tile_first_word_;
  std::vector<std::uint32_t> run_offset_;
  std::vector<std::uint64_t> runs_;
  TransportView view_;
};

}  // namespace rimlight
