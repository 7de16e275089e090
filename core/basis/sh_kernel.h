#pragma once

#include <cstddef>
#include <span>

#include "core/basis/sh_directions.h"

namespace rimlight::sh {

/// All Y_lm to a degree (convention: sh.h) at many directions:
///   values   [(degree + 1)²][stride], row-major: the first `directions` of each row are written;
///            64-byte aligned, stride a multiple of kDirectionLanes; fastest while the values stay
///            in a cache: go by blocks of 64 to 256 directions
/// A direction is normalised first, so that its length does not matter while its square stays
/// finite in double. (0, 0, 0) gives NaN. CheckFailure for shapes or a degree out of range.
/// Error: below 4.1e-7 to degree 32, 5.8e-7 to 64. The recurrence runs in double: in float it would
/// lose l²·2⁻²⁴ near the poles, where Y_l0 falls by l(l + 1)/2 of itself for each unit of z; only
/// the last product is in float. Allocates nothing.
void evaluate(const DirectionSpans& directions, int degree, std::span<float> values,
              std::size_t stride);

/// Y_l0 only, at cosines: values [degree + 1][stride], else as above. Cosines are in [−1, 1].
void evaluate_zonal(std::span<const float> cosines, int degree, std::span<float> values,
                    std::size_t stride);

/// The SIMD target in use ("AVX2", …).
const char* kernel_target();

}  // namespace rimlight::sh
