#pragma once

#include <array>
#include <numbers>
#include <span>

#include "core/basis/daubechies_interval.h"

/// The filters of DaubechiesInterval.
namespace rimlight::daubechies {

using InnerTaps = std::array<double, 4>;
inline constexpr double kRoot3 = std::numbers::sqrt3;
inline constexpr double kScale = 1 / (4 * std::numbers::sqrt2);
/// Daubechies (1988) with 2 vanishing moments: h, and g_t = (−1)^t h_(3−t).
inline constexpr InnerTaps kLow = {(1 + kRoot3) * kScale, (3 + kRoot3) * kScale,
                                   (3 - kRoot3) * kScale, (1 - kRoot3) * kScale};
inline constexpr InnerTaps kHigh = {kLow[3], -kLow[2], kLow[1], -kLow[0]};

/// The filters of one level from what constant and linear samples have become there: two
/// independent sequences of one length, a power of two from 4 on.
DaubechiesInterval::Level make_level(std::span<const double> constant,
                                     std::span<const double> linear);

}  // namespace rimlight::daubechies
