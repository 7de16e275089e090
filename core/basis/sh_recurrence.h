#pragma once

#include <array>
#include <cstddef>

#include "core/basis/sh.h"

namespace rimlight::sh {

/// Q_l^m = a·z·Q_{l−1}^m − b·Q_{l−2}^m, for one l and m.
struct RecurrenceStep {
  double a = 0, b = 0;
};

/// The recurrence of the Q_l^m of sh.h in l at fixed m, which is the stable direction: from
///   Q_m^m = √((2 − δ_m0) (2m + 1)!! / (4π (2m)!!)),   Q_{m−1}^m = 0
/// with, l > m,
///   a² = (4l² − 1) / (l² − m²),   b² = (2l + 1)((l − 1)² − m²) / ((2l − 3)(l² − m²)).
/// They are the associated Legendre functions without their factor (1 − z²)^(m/2), which is in
/// (x + iy)^m: so nothing is divided by the distance from a pole, and the largest number to
/// degree 32 is Q_32^14(±1) ≈ 2e6. (The usual recurrence, e.g. Press et al. 2007, section 6.7.)
struct Recurrence {
  std::array<double, kLargestLightDegree + 1> first{};  // [m] Q_m^m
  std::array<RecurrenceStep, kLargestLightDegree*(kLargestLightDegree + 1) / 2> steps{};

  /// The steps of an m, from l = m + 1 up.
  const RecurrenceStep* steps_of(int m) const {
    return steps.data() + static_cast<std::size_t>(m * kLargestLightDegree - m * (m - 1) / 2);
  }
};

/// Computed once, for all degrees.
const Recurrence& recurrence();

}  // namespace rimlight::sh
