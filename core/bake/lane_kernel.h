#pragma once

#include <cstddef>
#include <span>

#include "core/bake/group.h"
#include "core/light/cube_light.h"
#include "core/math/vec.h"

namespace rimlight {

/// sum[c][lane] += weights[c][lane] · value[c], for the 3 × 64 lanes of a group.
///   sum, weights  [kRowLanes], 64-byte aligned, not overlapping
void add_weighted_lanes(const float* weights, const Vec3f& value, float* sum);

/// For each light: image[c][lane] = Σ_j light[c][j] · rows[j][c][lane].
///   lights  coefficients (or texels) in the rows' order
///   images  [lights][kRowLanes], overwritten
/// fp32 sums in blocks of rows: relative error below 1e-5 of Σ|light · row|.
void multiply_rows(const GroupRows& rows, std::span<const CubeLight> lights, float* images);

}  // namespace rimlight
