#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/aligned_vector.h"
#include "core/math/vec.h"

namespace rimlight {

/// Receivers (rows of M) are stored in tiles of 4,096, a tile in blocks of 8: the unit of a sparse
/// column. What belongs to receivers lies as [tile][block][channel][8], so that a block's channel
/// is one SIMD vector.
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

/// Three numbers for each receiver, or for each pixel Haar coefficient: [tile][block][channel][8].
/// Zero when made.
class ReceiverValues {
 public:
  ReceiverValues() = default;
  explicit ReceiverValues(std::size_t tile_count) : values_(tile_count * kTileFloats) {}

  std::size_t tile_count() const { return values_.size() / kTileFloats; }
  float* tile(std::size_t t) { return values_.data() + t * kTileFloats; }
  const float* tile(std::size_t t) const { return values_.data() + t * kTileFloats; }
  std::span<float, kTileFloats> tile_span(std::size_t t) {
    return std::span<float, kTileFloats>(tile(t), kTileFloats);
  }
  std::span<const float, kTileFloats> tile_span(std::size_t t) const {
    return std::span<const float, kTileFloats>(tile(t), kTileFloats);
  }
  Vec3f at(std::size_t receiver) const {
    const float* const first = values_.data() + place(receiver);
    return {first[0], first[kBlockReceivers], first[2 * kBlockReceivers]};
  }
  void set(std::size_t receiver, const Vec3f& value) {
    float* const first = values_.data() + place(receiver);
    for (int c = 0; c < 3; ++c) first[static_cast<std::size_t>(c) * kBlockReceivers] = value[c];
  }

 private:
  static std::size_t place(std::size_t receiver) {
    return receiver / kBlockReceivers * kBlockFloats + receiver % kBlockReceivers;
  }

  AlignedVector<float> values_;
};

}  // namespace rimlight
