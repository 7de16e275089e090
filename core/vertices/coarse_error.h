#pragma once

#include <array>
#include <cstddef>

#include "core/relight/tile_image.h"

namespace rimlight {

/// How much the known pixels of a coarse view (even x and y) differ from their neighbours, summed
/// over pairs in a tile: to the right, below, and both.
struct TileVariation {
  struct Lag {
    double near = 0, far = 0;  // Σ of squares, at 2 pixels and at 4
    std::size_t near_pairs = 0, far_pairs = 0;
  };
  std::array<Lag, 3> lags;
  std::size_t known = 0;  // pixels

  TileVariation& operator+=(const TileVariation& other);

  /// Estimated Σ of squares of what the missing pixels differ by from the known ones in their
  /// place. Each is one pixel from it: to the right, below, or both. What differs by D₂ in the mean
  /// at two pixels and D₄ at four differs by D₂ · D₂/D₄ at one, if it goes on the same way (as a
  /// slope, a quarter; as an edge, half; as noise, all of it: the ratio is kept within those).
  double square_of_missing() const;
};

/// Of the tile's first width × height pixels. What is not covered counts as black.
TileVariation variation_of(const TileImage& image, int width, int height);

}  // namespace rimlight
