#include "core/transport/receivers.h"

#include "core/base/check.h"

namespace rimlight {
namespace {

constexpr int kGroupsAcross = PixelLayout::kTileSide / PixelLayout::kGroupSide;
constexpr int kBlockWidth = 4;
constexpr int kBlockHeight = 2;
constexpr int kBlocksAcross = PixelLayout::kGroupSide / kBlockWidth;

/// The next digit of a mixed-radix number, least significant first.
int take_digit(std::size_t& number, int radix) {
  const auto digit = static_cast<int>(number % static_cast<std::size_t>(radix));
  number /= static_cast<std::size_t>(radix);
  return digit;
}

}  // namespace

std::size_t PixelLayout::receiver(int x, int y) const {
  RIMLIGHT_CHECK(x >= 0 && x < width && y >= 0 && y < height);
  const auto tile =
      static_cast<std::size_t>(y / kTileSide) * static_cast<std::size_t>(tiles_across()) +
      static_cast<std::size_t>(x / kTileSide);
  const int tile_x = x % kTileSide, tile_y = y % kTileSide;
  const int group = tile_y / kGroupSide * kGroupsAcross + tile_x / kGroupSide;
  const int group_x = tile_x % kGroupSide, group_y = tile_y % kGroupSide;
  const int block = group_y / kBlockHeight * kBlocksAcross + group_x / kBlockWidth;
  const int in_block = group_y % kBlockHeight * kBlockWidth + group_x % kBlockWidth;
  return tile * kTileReceivers + static_cast<std::size_t>(group) * kGroupReceivers +
         static_cast<std::size_t>(block) * kBlockReceivers + static_cast<std::size_t>(in_block);
}

PixelLayout::Pixel PixelLayout::pixel(std::size_t receiver) const {
  RIMLIGHT_CHECK(receiver < receiver_count());
  const int in_block_x = take_digit(receiver, kBlockWidth);
  const int in_block_y = take_digit(receiver, kBlockHeight);
  const int block_x = take_digit(receiver, kBlocksAcross);
  const int block_y = take_digit(receiver, kGroupSide / kBlockHeight);
  const int group_x = take_digit(receiver, kGroupsAcross);
  const int group_y = take_digit(receiver, kGroupsAcross);
  const int tile_x = take_digit(receiver, tiles_across());
  const auto tile_y = static_cast<int>(receiver);
  return {tile_x * kTileSide + group_x * kGroupSide + block_x * kBlockWidth + in_block_x,
          tile_y * kTileSide + group_y * kGroupSide + block_y * kBlockHeight + in_block_y};
}

}  // namespace rimlight
