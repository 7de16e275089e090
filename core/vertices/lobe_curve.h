#pragma once

#include <span>

#include "core/basis/sh_zonal.h"

namespace rimlight {

/// The lobe that a curve describes (MaterialEdit::lobe): values evenly spaced over the angle from
/// the axis, from 0° to 90°, linear in between, nothing behind; scaled so that its integral over
/// the sphere is 1, as phong_lobe()'s is. Integrated piece by piece: sampled_lobe()'s fixed points
/// would miss most of a peak that is narrower than their distance. To 1e-12. Throws Error (where
/// "lobe") when check_lobe() does.
sh::ZonalLobe curve_lobe(std::span<const double> values, int degree);

}  // namespace rimlight
