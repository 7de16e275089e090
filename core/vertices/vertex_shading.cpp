#include "core/vertices/vertex_shading.h"

#include <algorithm>
#include <cstdint>

#include "core/vertices/highlight_batch.h"

namespace rimlight {
namespace {

/// Pixels are shaded by so many in a square: those share vertices, and the rows of these stay in
/// the first-level cache.
constexpr int kBlockSide = 8;
static_assert(kBlockSide * kBlockSide == HighlightBatch::kPixels);
constexpr int kTileSide = static_cast<int>(TileImage::kSide);

class TileShader {
 public:
  TileShader(const VertexShading& shading, int left, int top, int width, int height,
             TileImage& image)
      : shading_(shading),
        left_(left),
        top_(top),
        width_(width),
        height_(height),
        share_(1.0f / static_cast<float>(shading.view.layer_count())),
        image_(image),
        highlights_(HighlightBatch::of_thread(shading)) {}

  /// Pixels from (x, y) of the tile on.
  void shade_block(int x, int y) {
    for (std::size_t layer = 0; layer < shading_.view.layer_count(); ++layer) {
      highlights_.clear();
      const int step = shading_.view.step(), side = kBlockSide * step;
      for (int row = y; row < std::min(y + side, height_); row += step) {
        for (int column = x; column < std::min(x + side, width_); column += step) {
          shade_pixel(layer, column, row);
        }
      }
      if (highlights_.size() > 0) add_highlights(layer);
    }
  }

 private:
  void shade_pixel(std::size_t layer, int column, int row) {
    const int x = left_ + column, y = top_ + row;
    if (shading_.view.hit(layer, x, y).is_miss()) return;
    const auto place = static_cast<std::uint32_t>(row * kTileSide + column);
    add_matt(shading_, layer, x, y, share_, place, image_);
    if (has_highlight(shading_, layer, x, y)) highlights_.add(shading_, layer, x, y, place);
  }

  void add_highlights(std::size_t layer) {
    highlights_.evaluate(shading_);
    for (std::size_t i = 0; i < highlights_.size(); ++i) {
      const std::uint32_t place = highlights_.tag(i);
      const int x = left_ + static_cast<int>(place) % kTileSide;
      const int y = top_ + static_cast<int>(place) / kTileSide;
      const Vec3f weight = material_at(shading_, layer, x, y).highlight * share_;
      const Vec3f radiance = weight * highlights_.radiance(i);
      for (std::size_t c = 0; c < 3; ++c) {
        image_.channel[c][place] += radiance[static_cast<int>(c)];
      }
    }
  }

  const VertexShading& shading_;
  int left_, top_, width_, height_;
  float share_;
  TileImage& image_;
  HighlightBatch& highlights_;
};

}  // namespace

void spread_known(TileImage& image) {
  for (auto& channel : image.channel) {
    for (std::size_t y = 0; y < TileImage::kSide; ++y) {
      for (std::size_t x = 0; x < TileImage::kSide; ++x) {
        const std::size_t known = (y & ~std::size_t{1}) * TileImage::kSide + (x & ~std::size_t{1});
        channel[y * TileImage::kSide + x] = channel[known];
      }
    }
  }
}

double sum_of_squares(const TileImage& image) {
  double square = 0;
  for (const auto& channel : image.channel) {
    for (const float value : channel) square += static_cast<double>(value) * value;
  }
  return square;
}

double shade_tile(const VertexShading& shading, int left, int top, TileImage& image) {
  for (auto& channel : image.channel) channel.fill(0);
  const int width = std::min(kTileSide, shading.view.width() - left);
  const int height = std::min(kTileSide, shading.view.height() - top);
  TileShader shader(shading, left, top, width, height, image);
  const int side = kBlockSide * shading.view.step();
  for (int y = 0; y < height; y += side) {
    for (int x = 0; x < width; x += side) shader.shade_block(x, y);
  }
  if (shading.view.step() == 2) spread_known(image);
  return sum_of_squares(image);
}

}  // namespace rimlight
