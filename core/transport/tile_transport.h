#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/base/half.h"
#include "core/transport/transport.h"

namespace rimlight {

/// The transport of one tile of 4,096 receivers, in column order: what TransportView holds a tile.
struct TileTransport {
  std::vector<std::uint32_t> column_offset;  // [columns + 1], in blocks, from 0
  std::vector<float> column_scale;           // [columns]: largest |m| of the run; 0 without blocks
  std::vector<std::uint16_t> block_index;    // [blocks], ascending in each run
  AlignedVector<Half> value;                 // [blocks][3][8]: m / scale, in [−1, 1]

  std::size_t column_count() const { return column_scale.size(); }
  std::size_t block_count() const { return block_index.size(); }
  friend bool operator==(const TileTransport&, const TileTransport&) = default;
};

/// Leaves out each block whose largest |m| times its column's weight is not above `threshold`, as
/// TileBuilder does, but decided on the stored halves. Scales stay: a run loses its largest block
/// last. `weights` [columns] ≥ 0.
TileTransport prune(const TileTransport& tile, std::span<const float> weights, float threshold);

/// Transport in memory: owns the arrays of its view. Movable; immutable; any thread.
class Transport {
 public:
  /// All tiles have the same number of columns, else CheckFailure. Checks what TransportView does.
  explicit Transport(std::span<const TileTransport> tiles);
  Transport(Transport&&) noexcept = default;
  Transport& operator=(Transport&&) noexcept = default;

  const TransportView& view() const { return view_; }

 private:
  std::vector<std::uint64_t> tile_first_block_;
  std::vector<std::uint32_t> column_offset_;
  std::vector<float> column_scale_;
  std::vector<std::uint16_t> block_index_;
  AlignedVector<Half> value_;
  TransportView view_;
};

/// A finished tile of an unfinished bake, to resume from. The file is `path`, and beside it
/// `path`.json with its hashes and `fingerprint`, which says what the tile was made from. Both are
/// written beside and renamed: a killed writer leaves no part that loads. Throws Error.
void save_part(const std::filesystem::path& path, const TileTransport& tile,
               std::uint64_t fingerprint);

/// The tile, or nothing when the part is missing, damaged, or of another fingerprint or number of
/// columns: then it is made again.
std::optional<TileTransport> load_part(const std::filesystem::path& path, std::size_t column_count,
                                       std::uint64_t fingerprint);

}  // namespace rimlight
