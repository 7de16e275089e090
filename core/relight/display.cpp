#include "core/relight/display.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/base/parallel.h"
#include "core/image/tone_map.h"

namespace rimlight {
namespace {

void add_background(std::span<const BackgroundPixels::Pixel> pixels, const BackgroundMap& map,
                    const float (&to_source)[3][3], TileImage& image) {
  BackgroundLookUps look_ups;
  std::ranges::fill(look_ups.z, 1.0f);  // nothing is looked up along zero
  for (std::size_t begin = 0; begin < pixels.size(); begin += kLookUps) {
    const auto part = pixels.subspan(begin, std::min(kLookUps, pixels.size() - begin));
    for (std::size_t i = 0; i < part.size(); ++i) {
      look_ups.x[i] = part[i].direction.x;
      look_ups.y[i] = part[i].direction.y;
      look_ups.z[i] = part[i].direction.z;
    }
    look_up(map.faces(), to_source, part.size(), look_ups);
    for (std::size_t i = 0; i < part.size(); ++i) {
      const std::size_t at = part[i].y * TileImage::kSide + part[i].x;
      for (std::size_t c = 0; c < 3; ++c) {
        image.channel[c][at] += part[i].share * look_ups.radiance[i][c];
      }
    }
  }
}

/// Σ of squares; a few float sums of one tile each.
double square_of(std::span<const float, kTileFloats> radiance) {
  std::array<float, kBlockFloats> sums{};
  for (std::size_t at = 0; at < kTileFloats; at += kBlockFloats) {
    for (std::size_t i = 0; i < kBlockFloats; ++i) sums[i] += radiance[at + i] * radiance[at + i];
  }
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

/// The same of a tile's pixels.
double square_of(const TileImage& image) {
  double sum = 0;
  for (const auto& channel : image.channel) {
    std::array<float, TileImage::kSide> sums{};
    for (std::size_t at = 0; at < channel.size(); at += sums.size()) {
      for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += channel[at + i] * channel[at + i];
    }
    sum += std::accumulate(sums.begin(), sums.end(), 0.0);
  }
  return sum;
}

}  // namespace

Display::Display(const PixelLayout& layout, const Camera& camera, std::span<const float> coverage)
    : layout_(layout),
      background_pixels_(layout, camera, coverage),
      tile_square_(layout.tile_count()) {}

Display::FillTile Display::tiles_of(const Relighter& relighter, const ImageLayer* layer) {
  return [&relighter, layer](std::size_t tile, TileImage& image) {
    alignas(64) std::array<float, kTileFloats> radiance;
    relighter.find_radiance(tile, radiance);
    rows_from_blocks(radiance, image);
    const bool has_more = layer != nullptr && layer->add(tile, image);
    return has_more ? square_of(image) : square_of(radiance);
  };
}

void Display::set_view(const Camera& camera, std::span<const float> coverage) {
  background_pixels_ = BackgroundPixels(layout_, camera, coverage);
}

template <typename Visit>
void Display::for_each_tile(const FillTile& fill, const Background& background,
                            const Visit& visit) {
  const Matrix3 turn = matrix(conjugate(background.rotation));
  float to_source[3][3];
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      to_source[row][column] = static_cast<float>(turn.row[row][column]);
    }
  }
  const auto show_tile = [&](std::size_t tile) {
    TileImage image;
    tile_square_[tile] = fill(tile, image);
    add_background(background_pixels_.of_tile(tile), background.map, to_source, image);
    const auto [left, top] = layout_.pixel(tile * kTileReceivers);
    visit(Place{left, top, std::min(PixelLayout::kTileSide, layout_.width - left),
                std::min(PixelLayout::kTileSide, layout_.height - top)},
          image);
  };
  parallel_for(layout_.tile_count(), show_tile);
}

double Display::show(const FillTile& fill, const Background& background, float scale,
                     Rgb8Image& frame) {
  frame.resize(layout_.width, layout_.height);
  for_each_tile(fill, background, [&](const Place& place, const TileImage& image) {
    const auto width = static_cast<std::size_t>(place.width);
    for (int y = 0; y < place.height; ++y) {
      const auto row = [&](std::size_t c) {
        return std::span(image.channel[c])
            .subspan(static_cast<std::size_t>(y) * TileImage::kSide, width);
      };
      const int first = (place.top + y) * layout_.width + place.left;
      tone_map(row(0), row(1), row(2), scale,
               std::span(frame.bytes).subspan(3 * static_cast<std::size_t>(first), 3 * width));
    }
  });
  return std::sqrt(std::accumulate(tile_square_.begin(), tile_square_.end(), 0.0));
}

void Display::show(const FillTile& fill, const Background& background, RgbImage& image) {
  image = RgbImage(layout_.width, layout_.height);
  for_each_tile(fill, background, [&](const Place& place, const TileImage& tile) {
    for (int y = 0; y < place.height; ++y) {
      for (int x = 0; x < place.width; ++x) {
        const auto at =
            static_cast<std::size_t>(y) * TileImage::kSide + static_cast<std::size_t>(x);
        image.at(place.left + x, place.top + y) = {tile.channel[0][at], tile.channel[1][at],
                                                   tile.channel[2][at]};
      }
    }
  });
}

}  // namespace rimlight
