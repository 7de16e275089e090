#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/math/vec.h"

namespace rimlight {

/// A column of T̂ and what it is multiplied by.
struct CurveColumn {
  std::uint32_t coefficient = 0;
  Vec3f delta;
};

/// image += Σ delta · T̂_column of one panel, in the order of `columns`:
///   numbers  [256][3][64], aligned to 64 bytes
///   steps    [256][3]
///   image    [3][64], aligned to 64 bytes
void add_curve_columns(const std::int16_t* numbers, const float* steps,
                       std::span<const CurveColumn> columns, float* image) noexcept;

}  // namespace rimlight
