#pragma once

#include <span>

#include "core/math/vec.h"
#include "core/vertices/vertex_selection.h"

namespace rimlight {

/// Irradiance that nothing shadows: a polynomial of the normal, with the coefficients of the light
/// times those of the clamped cosine (Ramamoorthi and Hanrahan 2001, eq. 7),
///
///   E(n) = Σ_lm √(4π/(2l + 1)) a_l0 L_lm Y_lm(n)
///
/// 9 of them to degree 2, where nothing is at degree 3; 25 to degree 4.
///   normals     [vertex], of any length but zero
///   light       [3][(degree + 1)²]
///   irradiance  [panel][3][kBatchVertices] of the selection, 0 in the padding
/// Parallel over panels; a vertex has the same bits whatever else is selected. CheckFailure when
/// the selection goes beyond the normals or a span has the wrong size.
void open_irradiance(const VertexSelection& selection, std::span<const Vec3f> normals,
                     std::span<const float> light, int degree, std::span<float> irradiance);

}  // namespace rimlight
