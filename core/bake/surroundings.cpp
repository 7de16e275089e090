#include "core/bake/surroundings.h"

#include "core/base/check.h"

namespace rimlight {
namespace {

/// PixelLayout counts a group's lanes in blocks of 4×2 pixels: bits y₂ y₁ x₂ y₀ x₁ x₀. This swaps
/// x₂ and y₀, which makes rows of 8 pixels of it, and back.
LaneSet swap_block_order(LaneSet lanes) {
  constexpr LaneSet kRightOfUpperRow = 0x00f0'00f0'00f0'00f0;
  const LaneSet different = ((lanes >> 4) ^ lanes) & kRightOfUpperRow;
  return lanes ^ different ^ (different << 4);
}

/// One face of a plane of answers.
class Face {
 public:
  Face(const LaneSet* texels, std::size_t size) : texels_(texels), size_(size) {}

  LaneSet around(std::size_t row, std::size_t column) const {
    LaneSet result = beside(row, column) | lanes_beside(at(row, column));
    if (row > 0) result |= beside(row - 1, column) | at(row - 1, column);
    if (row + 1 < size_) result |= beside(row + 1, column) | at(row + 1, column);
    return result;
  }

 private:
  LaneSet at(std::size_t row, std::size_t column) const { return texels_[row * size_ + column]; }
  LaneSet beside(std::size_t row, std::size_t column) const {
    const LaneSet left = column > 0 ? at(row, column - 1) : 0;
    return column + 1 < size_ ? left | at(row, column + 1) : left;
  }

  const LaneSet* texels_;
  std::size_t size_;
};

}  // namespace

LaneSet lanes_beside(LaneSet lanes) {
  constexpr LaneSet kLeftColumn = 0x0101'0101'0101'0101;
  constexpr LaneSet kRightColumn = kLeftColumn << 7;
  const LaneSet rows = swap_block_order(lanes);
  const LaneSet beside = ((rows & ~kRightColumn) << 1) | ((rows & ~kLeftColumn) >> 1);
  const LaneSet wide = rows | beside;
  return swap_block_order(beside | (wide << 8) | (wide >> 8));
}

void find_mixed_surroundings(int cube_size, std::span<const LaneSet> lit,
                             std::span<const LaneSet> dark, std::span<LaneSet> mixed) {
  const auto size = static_cast<std::size_t>(cube_size);
  const std::size_t count = cube::texel_count(cube_size);
  RIMLIGHT_CHECK(lit.size() == count && dark.size() == count && mixed.size() == count);
  for (std::size_t begin = 0; begin < count; begin += size * size) {
    const Face lit_face(lit.data() + begin, size);
    const Face dark_face(dark.data() + begin, size);
    for (std::size_t row = 0; row < size; ++row) {
      for (std::size_t column = 0; column < size; ++column) {
        mixed[begin + row * size + column] =
            lit_face.around(row, column) & dark_face.around(row, column);
      }
    }
  }
}

}  // namespace rimlight
