#pragma once

#include <cstddef>
#include <vector>

#include "core/basis/cube_map.h"

namespace rimlight::reference {

/// The cube Haar basis written out from its definition, one function at a time, in double: the
/// values of basis function `coefficient` at all texels of a cube map of `size`.
inline std::vector<double> haar_function(std::size_t coefficient, int size) {
  std::size_t face = coefficient / 4, kind = coefficient % 4, side = 1, row = 0, column = 0;
  if (coefficient >= std::size_t{4} * cube::kFaces) {
    side = 2;
    while (coefficient >= cube::kFaces * 4 * side * side) side *= 2;
    const std::size_t within = coefficient - cube::kFaces * side * side;
    column = within % side;
    row = within / side % side;
    kind = within / (side * side) % 3 + 1;
    face = within / (side * side) / 3;
  }
  const std::size_t n = static_cast<std::size_t>(size);
  const std::size_t width = n / side;  // of the support, in texels
  std::vector<double> values(cube::texel_count(size), 0.0);
  for (std::size_t r = 0; r < width; ++r) {
    for (std::size_t c = 0; c < width; ++c) {
      const bool right = c >= width / 2, upper = r >= width / 2;
      const double sign_x = (kind & 1) != 0 && right ? -1 : 1;
      const double sign_y = (kind & 2) != 0 && upper ? -1 : 1;
      values[(face * n + row * width + r) * n + column * width + c] =
          sign_x * sign_y / static_cast<double>(width);
    }
  }
  return values;
}

}  // namespace rimlight::reference
