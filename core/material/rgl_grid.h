#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace rimlight {

/// A point of the unit square.
struct SquarePoint {
  double x = 0, y = 0;
};

/// A table over the unit square, bilinear between its values; the outermost lie on the edges.
struct RglGrid {
  std::size_t columns = 0, rows = 0;  // at least 2 each
  std::vector<float> values;          // [row][column], ≥ 0

  /// Negative values become 0.
  RglGrid(std::size_t columns, std::size_t rows, std::span<const float> values);
  double at(const SquarePoint& point) const;
};

/// A bilinear density over the unit square, one for each value of a parameter and linear between
/// them, with the map that makes it uniform: first in x within its row, then in y.
class RglWarp {
 public:
  /// Grids of one size, at least one. Each is scaled to integrate to 1 (one of zeros stays).
  explicit RglWarp(std::vector<RglGrid> grids);

  /// The parameter between grid `lower` and the next: share in [0, 1] of the latter.
  struct Place {
    std::size_t lower = 0;
    double share = 0;
  };
  /// Where `point` lies in the uniform square: the density's integral over lower x in its row, as a
  /// share of the row's, and over the rows of lower y.
  SquarePoint uniform(const Place& at, const SquarePoint& point) const;
  /// The scaled density; per area of the unit square.
  double density(const Place& at, const SquarePoint& point) const;

 private:
  struct Layer {
    RglGrid density;
    std::vector<double> row_sums;   // [row][column]: ∫ along the row up to the column, in columns
    std::vector<double> marginals;  // [row]: ∫ of the rows' integrals up to the row, in rows
  };
  std::vector<Layer> layers_;
};

}  // namespace rimlight
