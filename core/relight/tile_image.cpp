#include "core/relight/tile_image.h"

#include <algorithm>

namespace rimlight {

void rows_from_blocks(std::span<const float, kTileFloats> radiance, TileImage& image) {
  constexpr std::size_t kRun = 4;        // pixels of a row in a block, which is 4 × 2
  constexpr std::size_t kGroupSide = 8;  // pixels; a group is 2 × 4 blocks, a tile 8 × 8 groups
  constexpr std::size_t kGroupBlocks = 8;
  for (std::size_t c = 0; c < 3; ++c) {
    float* row = image.channel[c].data();
    for (std::size_t y = 0; y < TileImage::kSide; ++y, row += TileImage::kSide) {
      for (std::size_t x = 0; x < TileImage::kSide; x += kRun) {
        const std::size_t group = y / kGroupSide * kGroupSide + x / kGroupSide;
        const std::size_t block =
            group * kGroupBlocks + y % kGroupSide / 2 * 2 + x % kGroupSide / kRun;
        std::copy_n(radiance.data() + block * kBlockFloats + c * kBlockReceivers + y % 2 * kRun,
                    kRun, row + x);
      }
    }
  }
}

}  // namespace rimlight
