#include "core/transport/curve_receivers.h"

#include <algorithm>

#include "core/base/check.h"
#include "core/basis/cube_map.h"

namespace rimlight {
namespace {

constexpr auto kSide = static_cast<std::size_t>(SkyVisibilityView::kBlockSide);

std::size_t blocks_across(int cube_size) { return static_cast<std::size_t>(cube_size) / kSide; }

/// Calls visit(block, texel) for the first texel of each block.
template <typename Visit>
void for_each_block(int cube_size, const Visit& visit) {
  const auto size = static_cast<std::size_t>(cube_size);
  std::size_t block = 0;
  for (std::size_t row = 0; row < cube::kFaces * size; row += kSide) {
    for (std::size_t column = 0; column < size; column += kSide) {
      visit(block++, row * size + column);
    }
  }
}

}  // namespace

std::size_t SkyVisibilityView::blocks_per_surface() const {
  return cube::kFaces * blocks_across(cube_size) * blocks_across(cube_size);
}

void SkyVisibilityView::unpack(std::size_t surface, std::span<std::uint8_t> fifths) const {
  RIMLIGHT_CHECK(surface < surface_count());
  RIMLIGHT_CHECK_EQ(fifths.size(), cube::texel_count(cube_size));
  const Block* const kinds = blocks.data() + surface * blocks_per_surface();
  const auto size = static_cast<std::size_t>(cube_size);
  std::size_t next = first_mixed[surface];
  for_each_block(cube_size, [&](std::size_t block, std::size_t first) {
    if (kinds[block] != Block::mixed) {
      const std::uint8_t value = kinds[block] == Block::all ? kAll : 0;
      for (std::size_t row = 0; row < kSide; ++row) {
        std::fill_n(fifths.data() + first + row * size, kSide, value);
      }
      return;
    }
    const auto& bytes = mixed[next++];
    for (std::size_t i = 0; i < kMixedBytes; ++i) {
      std::uint8_t* const two = fifths.data() + first + (2 * i / kSide) * size + 2 * i % kSide;
      two[0] = bytes[i] & 15u;
      two[1] = static_cast<std::uint8_t>(bytes[i] >> 4u);
    }
  });
}

SkyVisibilityPacker::SkyVisibilityPacker(int cube_size) : cube_size_(cube_size) {
  RIMLIGHT_CHECK(cube_size >= SkyVisibilityView::kBlockSide &&
                 cube_size % SkyVisibilityView::kBlockSide == 0);
}

void SkyVisibilityPacker::add(std::span<const std::uint8_t> fifths) {
  using Block = SkyVisibilityView::Block;
  RIMLIGHT_CHECK_EQ(fifths.size(), cube::texel_count(cube_size_));
  const auto size = static_cast<std::size_t>(cube_size_);
  for_each_block(cube_size_, [&](std::size_t, std::size_t first) {
    std::array<std::uint8_t, SkyVisibilityView::kMixedBytes> bytes{};
    bool is_none = true, is_all = true;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const std::uint8_t* const two =
          fifths.data() + first + (2 * i / kSide) * size + 2 * i % kSide;
      RIMLIGHT_CHECK(two[0] <= SkyVisibilityView::kAll && two[1] <= SkyVisibilityView::kAll);
      is_none &= two[0] == 0 && two[1] == 0;
      is_all &= two[0] == SkyVisibilityView::kAll && two[1] == SkyVisibilityView::kAll;
      bytes[i] = static_cast<std::uint8_t>(two[0] | two[1] << 4u);
    }
    blocks_.push_back(is_none ? Block::none : is_all ? Block::all : Block::mixed);
    if (blocks_.back() == Block::mixed) mixed_.push_back(bytes);
  });
  first_mixed_.push_back(mixed_.size());
}

void SkyVisibilityPacker::append(const SkyVisibilityPacker& other) {
  RIMLIGHT_CHECK_EQ(other.cube_size_, cube_size_);
  const std::uint64_t before = mixed_.size();
  blocks_.insert(blocks_.end(), other.blocks_.begin(), other.blocks_.end());
  mixed_.insert(mixed_.end(), other.mixed_.begin(), other.mixed_.end());
  for (std::size_t i = 1; i < other.first_mixed_.size(); ++i) {
    first_mixed_.push_back(before + other.first_mixed_[i]);
  }
}

SkyVisibilityView SkyVisibilityPacker::view() const {
  SkyVisibilityView view;
  view.cube_size = cube_size_;
  view.blocks = blocks_;
  view.first_mixed = first_mixed_;
  view.mixed = mixed_;
  return view;
}

}  // namespace rimlight
