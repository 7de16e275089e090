#pragma once

#include <cstddef>

namespace rimlight {

/// A symmetric matrix times many receivers' coefficients:
///   matrix     [rows][stride]           transport, product  [rows][lanes], lanes a multiple of 16
struct ShMatrixProduct {
  const float* matrix;
  std::size_t stride;
  const float* transport;
  float* product;
  std::size_t lanes;
};
/// Indices from `begin` up to and without `end`.
struct ShIndexRange {
  std::size_t begin, end;
};

/// product[i] += Σ_j matrix[i][j] · transport[j] for i of `rows`, j of `columns`. Each product is
/// one sum in the order of j.
void add_matrix_product(const ShMatrixProduct& whole, const ShIndexRange& rows,
                        const ShIndexRange& columns) noexcept;

}  // namespace rimlight
