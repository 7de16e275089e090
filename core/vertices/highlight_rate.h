#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vertices/vertex_view.h"

namespace rimlight {

/// At how many pixels a frame evaluates highlights: at each, at one in 2 × 2, at one in 4 × 4.
enum class HighlightRate : std::uint8_t { every, quarter, sixteenth };
inline constexpr std::size_t kHighlightRates = 3;

/// Pixels from one on the grid of a rate to the next, both ways.
constexpr int spacing(HighlightRate rate) { return 1 << static_cast<int>(rate); }
constexpr std::size_t index_of(HighlightRate rate) { return static_cast<std::size_t>(rate); }

/// The four pixels on a rate's grid around a pixel (of like x or y: the two, at the corner itself
/// the one), as bits: 1 upper left, 2 upper right, 4 lower left, 8 lower right.
using GridCorners = std::uint8_t;
struct GridWeight {
  int x = 0, y = 0;  // of the pixel on the grid
  float weight = 0;
};
/// Bilinear weights of the corners in `fitting`, as parts of their sum.
std::array<GridWeight, 4> grid_weights(int x, int y, int spacing, GridCorners fitting);

/// For one view (its first layer), where highlights are evaluated at each rate and what the other
/// pixels get theirs from, and the vertices that takes. Depends on the view alone, so that a light
/// that turns over a view standing still needs it once.
///
/// A pixel that is not on the grid takes its highlight from those of the corners around it that
/// are like it: of the same material, mirrored nearly to where it is itself, near it in depth.
/// Where none is, it is evaluated itself. One pixel in kSampleShare of the others, chosen by a hash
/// of its place, is a sample: evaluated too, so that the error is known (MeasuredError).
///
/// One thread at a time; computes on all cores; allocates nothing after the first of its size.
class HighlightPlan {
 public:
  static constexpr std::uint32_t kSampleShare = 64;

  /// `degree`: of the highlights' harmonics, which says how near mirrored directions have to be.
  HighlightPlan(const VertexMesh& mesh, int degree);

  void find(const VertexView& view);

  /// The corners that a pixel is interpolated from; 0: it is evaluated, if it has a highlight.
  GridCorners corners(HighlightRate rate, int x, int y) const {
    if (rate == HighlightRate::every) return 0;
    const std::uint8_t both = corners_[index(x, y)];
    return rate == HighlightRate::quarter ? both & 15 : both >> 4;
  }
  /// Whether an interpolated pixel is a sample.
  static bool is_sample(int x, int y);

  /// Vertices whose arriving light a rate needs, rising. A finer rate has those of the coarser
  /// ones.
  std::span<const std::uint32_t> vertices(HighlightRate rate) const {
    return vertices_[index_of(rate)];
  }
  /// How many pixels are evaluated, samples included: of a tile (PixelLayout's order), of all.
  std::size_t evaluated(HighlightRate rate, std::size_t tile) const {
    return of_tiles_[tile][index_of(rate)];
  }
  std::size_t evaluated(HighlightRate rate) const;
  std::size_t tile_count() const { return of_tiles_.size(); }

 private:
  using Counts = std::array<std::size_t, kHighlightRates>;

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x);
  }
  void find_tile(const VertexView& view, std::size_t tile, double depth_of_pixel);
  void read_pixel(const VertexView& view, int x, int y, double depth_of_pixel, Counts& counts);
  GridCorners fitting(const VertexView& view, int x, int y, int spacing, double most_depth) const;
  void need(const VertexView& view, int x, int y, HighlightRate coarsest);

  const VertexMesh& mesh_;
  float least_cosine_;
  int width_ = 0;
  std::vector<std::uint8_t> corners_;  // [height][width]: of the quarter, and 16 × the sixteenth's
  std::vector<Counts> of_tiles_;
  std::vector<std::uint8_t> needed_;  // [vertex]: 1 + the coarsest rate that needs it
  std::array<std::vector<std::uint32_t>, kHighlightRates> vertices_;
};

}  // namespace rimlight
