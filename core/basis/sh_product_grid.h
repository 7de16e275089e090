#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/base/aligned_vector.h"

namespace rimlight {

/// The two kinds of small constant matrices that take harmonics to a grid on the sphere, or back.
enum class ShGridDirection { to_grid, from_grid };

/// Latitudes (half of them, see sh_latitudes.h) and azimuths (a quarter: φ = 2π (j + ½) / 4·count;
/// the others mirror them) on which sums are integrals, to a degree.
constexpr std::size_t sh_grid_count(int exact_degree) {
  return static_cast<std::size_t>(exact_degree) / 4 + 1;
}

/// One function's way to the grid, or from it, as products with small matrices. It goes over
/// *columns*: the (2n + 1) functions cos mφ, sin mφ, in four kinds that mirror alike:
///
///     cos, m even | cos, m odd | sin, m even | sin, m odd
///
/// Each matrix is packed for a kernel that keeps a block of rows in registers: blocks of kBlockRows
/// rows (the last may have fewer), each [column][row of the block].
struct ShGridTransform {
  static constexpr std::size_t kBlockRows = 8;
  static constexpr std::size_t kKinds = 4;

  struct Matrix {
    std::size_t rows = 0, columns = 0;
    std::size_t first = 0;  // in `values`
  };
  /// The latitudes of one column: two halves, l − m even (the same in the south) and odd (negated).
  struct Column {
    Matrix half[2];
    std::size_t first = 0;  // in `places`: the harmonics of the even half, then of the odd one
  };

  ShGridTransform(int degree, int exact_degree, ShGridDirection direction);

  std::vector<Column> columns;  // [2 degree + 1], by kind
  std::array<std::size_t, kKinds> kind_columns{};
  std::array<Matrix, kKinds> azimuths;  // between the columns of a kind and a quarter turn
  std::vector<std::size_t> places;      // [(degree + 1)²], coefficients in columns' order
  AlignedVector<float> values;
  double flops = 0;  // of one function, additions of the mirroring included
};

}  // namespace rimlight
