#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/image/image.h"
#include "core/math/camera.h"
#include "core/relight/background.h"
#include "core/relight/image_layer.h"
#include "core/relight/relighter.h"
#include "core/relight/tile_image.h"
#include "core/transport/receivers.h"

namespace rimlight {

/// B to pixels: takes radiance tile by tile, puts the environment behind what geometry leaves
/// uncovered, tone-maps. One thread at a time; computes on all cores, allocates nothing.
class Display {
 public:
  /// `coverage` [height][width] in [0, 1].
  Display(const PixelLayout& layout, const Camera& camera, std::span<const float> coverage);

  /// Another view: as if made anew.
  void set_view(const Camera& camera, std::span<const float> coverage);

  /// Writes the radiance of one tile's pixels, black outside the image; answers Σ of its squares.
  /// Called from several threads at once, once for each tile.
  using FillTile = std::function<double(std::size_t tile, TileImage& image)>;

  /// What a relighter holds, and a layer on it where there is one.
  static FillTile tiles_of(const Relighter& relighter, const ImageLayer* layer);

  /// The environment as it stands behind the pixels.
  struct Background {
    const BackgroundMap& map;
    Quaternion rotation;  // of the light
  };

  /// Pixels in sRGB; `scale` multiplies radiance. The frame is resized. Returns ‖B‖, √ of the sum
  /// over receivers and channels of its squares.
  double show(const FillTile& fill, const Background& background, float scale, Rgb8Image& frame);
  /// Pixels as linear radiance. The image is resized.
  void show(const FillTile& fill, const Background& background, RgbImage& image);

 private:
  /// Where a tile's pixels lie in the image, and how many of them are inside it.
  struct Place {
    int left, top, width, height;
  };
  template <typename Visit>
  void for_each_tile(const FillTile& fill, const Background& background, const Visit& visit);

  PixelLayout layout_;
  BackgroundPixels background_pixels_;
  std::vector<double> tile_square_;  // of B, [tile]
};

}  // namespace rimlight
