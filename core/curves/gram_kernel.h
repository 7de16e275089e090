#pragma once

#include <cstddef>

namespace rimlight {

/// gram[k][j] += Σ_row a[row][k] a[row][j] for j ≥ k (and some below), in squares of 256:
///   a     [64][256], aligned to 64 bytes
///   gram  [256][256], aligned to 64 bytes
void add_gram(const float* a, float* gram) noexcept;

}  // namespace rimlight
