#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/transport/receivers.h"

namespace rimlight {

/// One tile of 64 × 64 pixels, planar and row by row: [channel][row][column].
struct TileImage {
  static constexpr std::size_t kSide = PixelLayout::kTileSide;
  alignas(64) std::array<std::array<float, kSide * kSide>, 3> channel;
};

/// Pixels in rows from receivers in blocks: see PixelLayout. `radiance` is [block][3][8].
void rows_from_blocks(std::span<const float, kTileFloats> radiance, TileImage& image);

}  // namespace rimlight
