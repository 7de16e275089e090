#pragma once

#include <cstddef>

#include "core/basis/sh_product_grid.h"

namespace rimlight {

/// Two functions to the grid and their product back: what ShProduct::multiply() runs.
struct ShProductPlan {
  ShGridTransform first, second, product;
  std::size_t count;  // latitudes of a half, azimuths of a quarter

  /// Floats of a workspace for one vector of any target.
  std::size_t workspace_size() const;
  double flops() const;
};

/// Arrays as in ShProduct::multiply(); `lanes` a multiple of 16; workspace 64-byte aligned.
struct ShProductArrays {
  const float* first;
  const float* second;
  float* product;
  std::size_t lanes;
  float* workspace;
};
void multiply_harmonics(const ShProductPlan& plan, const ShProductArrays& arrays) noexcept;

}  // namespace rimlight
