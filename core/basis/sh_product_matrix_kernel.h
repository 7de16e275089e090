#pragma once

#include <cstddef>

#include "core/basis/sh_tripling.h"

namespace rimlight {

/// A light in the order in which a product matrix reads it: for each m ≥ 0 its degrees m, m + 2, …,
/// then m + 1, m + 3, …, to 2n; each {cosine: R, G, B, 0, sine: R, G, B, 0}.
struct ShPackedLight {
  static constexpr std::size_t kEntry = 8;

  int degree;           // 2n: how far it goes
  const float* values;  // 64-byte aligned; [(degree + 1) (degree + 2) / 2][kEntry]

  /// Where (l, m) is, in floats. Those before m have degree + 1, degree, … places.
  static constexpr std::size_t place(int degree, int l, int m) {
    const int before = m * (degree + 1) - m * (m - 1) / 2;
    const int odd = (l - m) & 1;
    const int evens = (degree - m) / 2 + 1;
    return kEntry * static_cast<std::size_t>(before + (odd != 0 ? evens : 0) + (l - m) / 2);
  }
};

/// M = Σ_k C(·, ·, k) L_k, or M += that, over k of degrees `first` … `last` of the light:
///   matrix  [3][(n + 1)²][stride], symmetric before as after; stride a multiple of 16, padded with
///   0 rows    [2][stride][kPixel], scratch that is 0 at first and then used for nothing else
/// All 64-byte aligned.
struct ShMatrixBuild {
  static constexpr std::size_t kPixel = 4;

  const ShTripling* table;  // to degree n
  ShPackedLight light;
  int first, last;
  bool adds;
  float* rows;
  float* matrix;
  std::size_t stride;
};
void build_product_matrix(const ShMatrixBuild& build) noexcept;

}  // namespace rimlight
