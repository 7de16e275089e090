#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/aligned_vector.h"
#include "core/relight/tile_image.h"
#include "core/vertices/vertex_lobe_kernel.h"
#include "core/vertices/vertex_shading.h"

namespace rimlight {

/// Adds a pixel's matt radiance, and the sun's, times `share`, to `place` of a tile. The pixel is a
/// hit.
void add_matt(const VertexShading& shading, std::size_t layer, int x, int y, float share,
              std::size_t place, TileImage& image);

/// What a pixel's highlight is of; nothing where it has none.
bool has_highlight(const VertexShading& shading, std::size_t layer, int x, int y);
const VertexMaterial& material_at(const VertexShading& shading, std::size_t layer, int x, int y);

/// Highlights of a few pixels, evaluated together. One thread.
class HighlightBatch {
 public:
  static constexpr std::size_t kPixels = 64;

  /// The calling thread's, empty, ready for this shading.
  static HighlightBatch& of_thread(const VertexShading& shading);

  void clear() { count_ = 0; }
  std::size_t size() const { return count_; }
  bool is_full() const { return count_ == kPixels; }
  /// One more pixel, which has a highlight; `tag` is the caller's.
  void add(const VertexShading& shading, std::size_t layer, int x, int y, std::uint32_t tag);

  /// The light that the lobe gathers at each, before the material's highlight weighs it.
  void evaluate(const VertexShading& shading);
  Vec3f radiance(std::size_t i) const {
    return {radiance_[3 * i], radiance_[3 * i + 1], radiance_[3 * i + 2]};
  }
  std::uint32_t tag(std::size_t i) const { return tags_[i]; }

 private:
  std::size_t count_ = 0;
  alignas(64) std::array<float, kPixels> x_{}, y_{}, z_{};  // mirrored directions
  std::array<MirroringPoint, kPixels> points_;
  std::array<std::uint32_t, kPixels> tags_{};
  std::array<float, 3 * kPixels> radiance_{};
  AlignedVector<float> panel_, rows_;  // harmonics: [coefficient][pixel], [pixel][stride]
};

}  // namespace rimlight
