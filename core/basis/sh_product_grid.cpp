#include "core/basis/sh_product_grid.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/basis/sh_latitudes.h"
#include "core/basis/sh_tripling.h"

namespace rimlight {
namespace {

using Matrix = ShGridTransform::Matrix;
using Entry = std::function<double(std::size_t row, std::size_t column)>;

Matrix pack(std::size_t rows, std::size_t columns, const Entry& entry,
            AlignedVector<float>& values) {
  const Matrix matrix = {rows, columns, values.size()};
  for (std::size_t first = 0; first < rows; first += ShGridTransform::kBlockRows) {
    const std::size_t end = std::min(rows, first + ShGridTransform::kBlockRows);
    for (std::size_t column = 0; column < columns; ++column) {
      for (std::size_t row = first; row < end; ++row) {
        values.push_back(static_cast<float>(entry(row, column)));
      }
    }
  }
  return matrix;
}

/// The same entries for [grid point][harmonic] and its transpose.
Matrix pack_between(std::size_t points, std::size_t harmonics, ShGridDirection direction,
                    const Entry& entry, AlignedVector<float>& values) {
  if (direction == ShGridDirection::to_grid) return pack(points, harmonics, entry, values);
  return pack(
      harmonics, points, [&](std::size_t row, std::size_t column) { return entry(column, row); },
      values);
}

/// The orders m of a kind: {cos, sin} × {even, odd}; there is no sine of order 0.
std::vector<int> orders_of(std::size_t kind, int degree) {
  std::vector<int> orders;
  for (int m = kind % 2 == 1 ? 1 : kind == 2 ? 2 : 0; m <= degree; m += 2) orders.push_back(m);
  return orders;
}

}  // namespace

ShGridTransform::ShGridTransform(int degree, int exact_degree, ShGridDirection direction) {
  const ShLatitudes latitudes(degree, exact_degree);
  const std::size_t count = sh_grid_count(exact_degree);
  const double step = 2 * std::numbers::pi / static_cast<double>(4 * count);
  const bool back = direction == ShGridDirection::from_grid;
  for (std::size_t kind = 0; kind < kKinds; ++kind) {
    const std::vector<int> orders = orders_of(kind, degree);
    const bool sine = kind >= 2;
    kind_columns[kind] = orders.size();
    azimuths[kind] = pack_between(
        count, orders.size(), direction,
        [&](std::size_t j, std::size_t i) {
          const double angle = orders[i] * (static_cast<double>(j) + 0.5) * step;
          return sine ? std::sin(angle) : std::cos(angle);
        },
        values);
    flops += static_cast<double>(2 * count * (2 * count * orders.size()));  // for each latitude
    for (const int m : orders) {
      Column column{{}, places.size()};
      const double scale = m == 0 ? 1 : std::numbers::sqrt2;
      for (int odd = 0; odd < 2; ++odd) {
        const auto harmonics = static_cast<std::size_t>(std::max(0, (degree - m - odd) / 2 + 1));
        const bool none = m + odd > degree;
        const auto entry = [&](std::size_t i, std::size_t k) {
          const double value = latitudes.values(m + odd + 2 * static_cast<int>(k), m)[i];
          return scale * value * (back ? latitudes.weights()[i] * step : 1);
        };
        column.half[odd] = pack_between(count, none ? 0 : harmonics, direction, entry, values);
        for (int l = m + odd; l <= degree; l += 2) {
          places.push_back(sh::index(l, sine ? -m : m));
        }
      }
      flops += static_cast<double>(2 * count);  // north and south
      columns.push_back(column);
    }
  }
  flops += static_cast<double>(2 * count * places.size());
}

}  // namespace rimlight
