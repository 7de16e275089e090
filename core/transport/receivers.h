#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/aligned_vector.h"

namespace rimlight {

/// Receivers (rows of M) are stored in tiles of 4,096, a tile in blocks of 8: the unit of a sparse
/// column. Radiance lies as [tile][block][channel][8], so that a block's channel is one SIMD
/// vector.
inline constexpr std::size_t kBlockReceivers = 8;
inline constexpr std::size_t kTileBlocks = 512;
inline constexpr std::size_t kTileReceivers = kTileBlocks * kBlockReceivers;
inline constexpr std::size_t kBlockFloats = 3 * kBlockReceivers;
inline constexpr std::size_t kTileFloats = kTileBlocks * kBlockFloats;

/// Pixels as receivers. Tiles are 64×64 pixels, row by row; a tile holds 8×8 groups of 8×8 pixels,
/// row by row; a group holds 8 blocks (two across, four down) of 4×2 pixels, row by row: blocks are
/// compact, so that neighbours share their zeros. Tiles at the right and bottom edge are padded
/// with receivers that stay black.
struct PixelLayout {
  int width = 0;
  int height = 0;

  static constexpr int kTileSide = 64;
  static constexpr int kGroupSide = 8;
  static constexpr std::size_t kGroupReceivers = 64;

  int tiles_across() const { return (width + kTileSide - 1) / kTileSide; }
  int tiles_down() const { return (height + kTileSide - 1) / kTileSide; }
  std::size_t tile_count() const {
    return static_cast<std::size_t>(tiles_across()) * static_cast<std::size_t>(tiles_down());
  }
  std::size_t receiver_count() const { return tile_count() * kTileReceivers; }

  /// The receiver of a pixel.
  std::size_t receiver(int x, int y) const;
  /// The pixel of a receiver; padded receivers give x ≥ width or y ≥ height.
  struct Pixel {
    int x, y;
  };
  Pixel pixel(std::size_t receiver) const;
};

/// B: radiance of all receivers, [tile][block][channel][8]. Zero when made.
class Radiance {
 public:
  Radiance() = default;
  explicit Radiance(std::size_t tile_count) : values_(tile_count * kTileFloats) {}

  std::size_t tile_count() const { return values_.size() / kTileFloats; }
  float* tile(std::size_t t) { return values_.data() + t * kTileFloats; }
  const float* tile(std::size_t t) const { return values_.data() + t * kTileFloats; }
  float at(std::size_t receiver, int channel) const {
    const std::size_t block = receiver / kBlockReceivers;
    return values_[block * kBlockFloats + static_cast<std::size_t>(channel) * kBlockReceivers +
                   receiver % kBlockReceivers];
  }

 private:
  AlignedVector<float> values_;
};

}  // namespace rimlight
