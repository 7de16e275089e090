#include "core/material/rgl_grid.h"

#include <algorithm>

#include "core/base/check.h"

namespace rimlight {
namespace {

/// Where a coordinate lies among `count` values: between `index` and the next.
struct Cell {
  std::size_t index = 0;
  double share = 0;
};

Cell cell_of(double at, std::size_t count) {
  const double position = std::clamp(at, 0.0, 1.0) * static_cast<double>(count - 1);
  const std::size_t index = std::min(static_cast<std::size_t>(position), count - 2);
  return {index, position - static_cast<double>(index)};
}

double mixed(double a, double b, double share) { return a + (b - a) * share; }

}  // namespace

RglGrid::RglGrid(std::size_t columns_, std::size_t rows_, std::span<const float> values_)
    : columns(columns_), rows(rows_), values(values_.begin(), values_.end()) {
  RIMLIGHT_CHECK(columns >= 2 && rows >= 2);
  RIMLIGHT_CHECK_EQ(values.size(), columns * rows);
  for (float& value : values) value = std::max(value, 0.0f);
}

double RglGrid::at(const SquarePoint& point) const {
  const Cell x = cell_of(point.x, columns), y = cell_of(point.y, rows);
  const float* const low = values.data() + y.index * columns + x.index;
  const float* const high = low + columns;
  return mixed(mixed(low[0], low[1], x.share), mixed(high[0], high[1], x.share), y.share);
}

// Sums by the trapezoid rule, which is exact for what is bilinear. Columns and rows count as 1
// wide, so that a density of the unit square is (columns − 1)(rows − 1) times as large.
RglWarp::RglWarp(std::vector<RglGrid> grids) {
  RIMLIGHT_CHECK(!grids.empty());
  for (RglGrid& grid : grids) {
    const std::size_t columns = grid.columns, rows = grid.rows;
    Layer layer{std::move(grid), std::vector<double>(columns * rows), std::vector<double>(rows)};
    std::vector<float>& values = layer.density.values;
    double whole = 0;
    for (std::size_t row = 0; row < rows; ++row) {
      for (std::size_t i = 1; i < columns; ++i) {
        const std::size_t at = row * columns + i;
        layer.row_sums[at] =
            layer.row_sums[at - 1] + 0.5 * (double{values[at - 1]} + double{values[at]});
      }
      if (row == 0) continue;
      whole += 0.5 * (layer.row_sums[row * columns - 1] + layer.row_sums[(row + 1) * columns - 1]);
      layer.marginals[row] = whole;
    }
    if (whole > 0) {
      for (float& value : values) value = static_cast<float>(value / whole);
      for (double& sum : layer.row_sums) sum /= whole;
      for (double& sum : layer.marginals) sum /= whole;
    }
    layers_.push_back(std::move(layer));
  }
}

SquarePoint RglWarp::uniform(const Place& at, const SquarePoint& point) const {
  const Layer& first = layers_[at.lower];
  const Layer& second = layers_[std::min(at.lower + 1, layers_.size() - 1)];
  const std::size_t columns = first.density.columns;
  const Cell x = cell_of(point.x, columns), y = cell_of(point.y, first.density.rows);
  const auto value = [&](std::size_t i) {
    return mixed(first.density.values[i], second.density.values[i], at.share);
  };
  const auto sum = [&](std::size_t i) {
    return mixed(first.row_sums[i], second.row_sums[i], at.share);
  };
  const auto along = [&](std::size_t row) {
    const std::size_t i = row * columns + x.index;
    const double left = value(i), right = value(i + 1);
    return sum(i) + x.share * (left + 0.5 * x.share * (right - left));
  };
  const double low = sum((y.index + 1) * columns - 1), high = sum((y.index + 2) * columns - 1);
  const double row = mixed(low, high, y.share);
  const double below = mixed(first.marginals[y.index], second.marginals[y.index], at.share);
  return {row > 0 ? mixed(along(y.index), along(y.index + 1), y.share) / row : point.x,
          below + y.share * (low + 0.5 * y.share * (high - low))};
}

double RglWarp::density(const Place& at, const SquarePoint& point) const {
  const RglGrid& first = layers_[at.lower].density;
  const RglGrid& second = layers_[std::min(at.lower + 1, layers_.size() - 1)].density;
  return mixed(first.at(point), second.at(point), at.share) *
         static_cast<double>((first.columns - 1) * (first.rows - 1));
}

}  // namespace rimlight
