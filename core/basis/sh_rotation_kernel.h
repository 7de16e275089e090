#pragma once

#include <cstddef>

#include "core/base/aligned_vector.h"
#include "core/basis/sh.h"

namespace rimlight::sh {

// Inside a band l the kernel of Rotation sorts the coefficients by symmetry, each class by falling
// |m|, so that exchanging y and z is four dense blocks, and a turn about z pairs whole vectors:
//
//   class        sign of y, z     m                      slots
//   aligned      even  even       l, l − 2, … ≥ 0        ⌊l/2⌋ + 1
//   raised       even  odd        l − 1, l − 3, … ≥ 0    ⌊(l + 1)/2⌋
//   sideways     odd   even       as aligned, negative; where m would be 0, an empty slot
//   twisted      odd   odd        as raised, negative; where m would be 0, an empty slot
//
// The exchange takes aligned and twisted to themselves, raised and sideways to each other.

constexpr int aligned_slots(int l) { return l / 2 + 1; }
constexpr int raised_slots(int l) { return (l + 1) / 2; }

/// Rows of a block are padded to whole vectors of the widest target.
inline constexpr int kSlotLanes = 8;
constexpr int padded_slots(int slots) { return (slots + kSlotLanes - 1) / kSlotLanes * kSlotLanes; }
inline constexpr int kLargestSlots = padded_slots(aligned_slots(kLargestLightDegree));

/// One band's exchange of y and z; each block column-major, [from slot][padded to slot], 64-byte
/// aligned, zero in padding and empty slots.
struct ExchangeBand {
  const double* aligned_to_aligned = nullptr;
  const double* twisted_to_twisted = nullptr;
  const double* raised_to_sideways = nullptr;
  const double* sideways_to_raised = nullptr;
};

/// All bands' exchange, J_mn = ∫ Y_lm(x, y, z) Y_ln(x, z, y) dω; computed once, by
/// quadrature that is exact for these polynomials: in some milliseconds for all l ≤ kLargestDegree,
/// and when a higher one is asked for, in some tens for the rest.
const ExchangeBand& exchange_band(int l);

/// cos mθ and sin mθ by falling m, even and odd m apart, padded with zeros.
struct AxialTurn {
  static constexpr int kCount = kLargestLightDegree / 2 + 1;
  double cosine[2][kCount + kSlotLanes] = {};
  double sine[2][kCount + kSlotLanes] = {};

  /// Where m's entry is, in the table of its parity.
  static constexpr int slot(int m) { return (kLargestLightDegree - m) / 2; }
};

/// A rotation as first Z(first), then J Z(middle) J, then Z(last); or only Z(last).
struct RotationTurns {
  int degree = 0;
  bool only_last = false;
  AxialTurn first, middle, last;
};

/// As Rotation::apply; `count` signals of (degree + 1)² coefficients.
void rotate(const RotationTurns& turns, const float* signals, float* rotated, std::size_t count);
void rotate(const RotationTurns& turns, const double* signals, double* rotated, std::size_t count);

}  // namespace rimlight::sh
