#include "core/basis/sh_rotation_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/basis/sh_rotation_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rimlight::sh {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using F64 = hn::CappedTag<double, kSlotLanes>;
using V = hn::Vec<F64>;
constexpr F64 kF64{};

/// One class of a band, of kSignals signals.
template <int kSignals>
struct Slots {
  alignas(64) double of[kSignals][kLargestSlots];
};

/// One band of kSignals signals, sorted.
template <int kSignals>
struct Band {
  Slots<kSignals> aligned, raised, sideways, twisted;
};

/// m and −m of the slots from `top` down, into both classes; `middle` is where m = 0. An empty slot
/// gets m = 0 too, which neither a turn (its sine is 0) nor an exchange (its block is 0) looks at.
template <int kSignals, typename T>
HWY_INLINE void gather(const T* middle, std::size_t stride, int top, int slots,
                       Slots<kSignals>& positive, Slots<kSignals>& negative) {
  for (int s = 0; s < kSignals; ++s) {
    const T* const from = middle + static_cast<std::size_t>(s) * stride;
    for (int i = 0; i < slots; ++i) {
      const int m = top - 2 * i;
      positive.of[s][i] = static_cast<double>(from[m]);
      negative.of[s][i] = static_cast<double>(from[-m]);
    }
  }
}

template <int kSignals, typename T>
HWY_INLINE void scatter(const Slots<kSignals>& positive, const Slots<kSignals>& negative, int top,
                        int slots, std::size_t stride, T* middle) {
  for (int s = 0; s < kSignals; ++s) {
    T* const to = middle + static_cast<std::size_t>(s) * stride;
    for (int i = 0; i < slots; ++i) {
      const int m = top - 2 * i;
      to[-m] = static_cast<T>(negative.of[s][i]);
      to[m] = static_cast<T>(positive.of[s][i]);  // last: an empty slot has m's place
    }
  }
}

/// Turns pairs (m, −m) of slots from `top` down about z.
template <int kSignals>
HWY_INLINE void turn(const AxialTurn& by, int top, int slots, Slots<kSignals>& positive,
                     Slots<kSignals>& negative) {
  const double* HWY_RESTRICT cosines = by.cosine[top & 1] + AxialTurn::slot(top);
  const double* HWY_RESTRICT sines = by.sine[top & 1] + AxialTurn::slot(top);
  for (int i = 0; i < slots; i += static_cast<int>(hn::Lanes(kF64))) {
    const V cosine = hn::LoadU(kF64, cosines + i), sine = hn::LoadU(kF64, sines + i);
    for (int s = 0; s < kSignals; ++s) {
      const V p = hn::Load(kF64, positive.of[s] + i), n = hn::Load(kF64, negative.of[s] + i);
      hn::Store(hn::NegMulAdd(sine, n, hn::Mul(cosine, p)), kF64, positive.of[s] + i);
      hn::Store(hn::MulAdd(sine, p, hn::Mul(cosine, n)), kF64, negative.of[s] + i);
    }
  }
}

template <int kSignals>
HWY_INLINE void turn(const AxialTurn& by, int l, Band<kSignals>& band) {
  turn(by, l, aligned_slots(l), band.aligned, band.sideways);
  if (l > 0) turn(by, l - 1, raised_slots(l), band.raised, band.twisted);
}

/// to = block · from.
template <int kSignals>
HWY_INLINE void multiply(const double* HWY_RESTRICT block, int from_slots, int to_slots,
                         const Slots<kSignals>& from, Slots<kSignals>& to) {
  const int rise = padded_slots(to_slots);
  for (int row = 0; row < to_slots; row += static_cast<int>(hn::Lanes(kF64))) {
    V sum[kSignals];
    for (V& one : sum) one = hn::Zero(kF64);
    const double* HWY_RESTRICT column = block + row;
    for (int i = 0; i < from_slots; ++i, column += rise) {
      const V factor = hn::Load(kF64, column);
      for (int s = 0; s < kSignals; ++s) {
        sum[s] = hn::MulAdd(factor, hn::Set(kF64, from.of[s][i]), sum[s]);
      }
    }
    for (int s = 0; s < kSignals; ++s) hn::Store(sum[s], kF64, to.of[s] + row);
  }
}

template <int kSignals>
HWY_INLINE void exchange(int l, const Band<kSignals>& from, Band<kSignals>& to) {
  const ExchangeBand& blocks = exchange_band(l);
  const int a = aligned_slots(l), r = raised_slots(l);
  multiply(blocks.aligned_to_aligned, a, a, from.aligned, to.aligned);
  multiply(blocks.twisted_to_twisted, r, r, from.twisted, to.twisted);
  multiply(blocks.raised_to_sideways, r, a, from.raised, to.sideways);
  multiply(blocks.sideways_to_raised, a, r, from.sideways, to.raised);
}

template <int kSignals, typename T>
HWY_NOINLINE void rotate_signals(const RotationTurns& turns, const T* signals, T* rotated) {
  const std::size_t stride = coefficient_count(turns.degree);
  // Zero, so that no slot of the padding is ever a signalling or denormal leftover.
  Band<kSignals> band = {}, other = {};
  for (int l = 0; l <= turns.degree; ++l) {
    const int a = aligned_slots(l), r = raised_slots(l);
    const T* const from = signals + index(l, 0);
    gather(from, stride, l, a, band.aligned, band.sideways);
    gather(from, stride, l - 1, r, band.raised, band.twisted);
    if (!turns.only_last) {
      turn(turns.first, l, band);
      exchange(l, band, other);
      turn(turns.middle, l, other);
      exchange(l, other, band);
    }
    turn(turns.last, l, band);
    T* const to = rotated + index(l, 0);
    scatter(band.aligned, band.sideways, l, a, stride, to);
    scatter(band.raised, band.twisted, l - 1, r, stride, to);
  }
}

template <typename T>
HWY_INLINE void rotate_all(const RotationTurns& turns, const T* signals, T* rotated,
                           std::size_t count) {
  const std::size_t stride = coefficient_count(turns.degree);
  std::size_t s = 0;
  for (; s + 3 <= count; s += 3) {
    rotate_signals<3>(turns, signals + s * stride, rotated + s * stride);
  }
  for (; s < count; ++s) rotate_signals<1>(turns, signals + s * stride, rotated + s * stride);
}

void rotate_floats(const RotationTurns& turns, const float* signals, float* rotated,
                   std::size_t count) {
  rotate_all(turns, signals, rotated, count);
}
void rotate_doubles(const RotationTurns& turns, const double* signals, double* rotated,
                    std::size_t count) {
  rotate_all(turns, signals, rotated, count);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rimlight::sh
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight::sh {

HWY_EXPORT(rotate_floats);
HWY_EXPORT(rotate_doubles);

void rotate(const RotationTurns& turns, const float* signals, float* rotated, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(rotate_floats)(turns, signals, rotated, count);
}
void rotate(const RotationTurns& turns, const double* signals, double* rotated, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(rotate_doubles)(turns, signals, rotated, count);
}

}  // namespace rimlight::sh
#endif  // HWY_ONCE
