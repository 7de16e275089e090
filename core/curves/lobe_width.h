#pragma once

#include <optional>

#include "core/material/brdf_curve.h"

namespace rimlight {

/// The angle θ_h within which half of the light goes that a curve over θ_h spreads,
/// ∫ c(θ_h) cos θ_h dω_h over all channels; radians, linear within a bin. Nothing for a black
/// curve.
std::optional<double> median_half_angle(const BrdfCurve& curve);

/// Whether the lobe of a curve over θ_h is narrower than a texel of a cube map of so many texels a
/// side: half of the light that it reflects comes from a disc of 4 · median_half_angle across
/// (the half vector turns by half of what the direction turns by).
bool is_finer_than_texels(const BrdfCurve& curve, int cube_size);

/// How wide a texel in the middle of a face is, in radians: 2 / N.
double texel_width(int cube_size);

}  // namespace rimlight
