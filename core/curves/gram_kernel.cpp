// Compiled once for each SIMD target; the one in use is chosen at the first call.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/curves/gram_kernel.cpp"
#include "core/curves/gram_kernel.h"

#include <hwy/foreach_target.h>  // IWYU pragma: keep; before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rimlight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 16>;
using Vector = hn::Vec<Floats>;

constexpr std::size_t kRows = 64, kColumns = 256;

struct Pair {
  Vector low, high;
};

HWY_INLINE Pair load(const float* from) {
  const Floats d;
  return {hn::Load(d, from), hn::Load(d, from + hn::Lanes(d))};
}

HWY_INLINE void add(Pair& sum, float factor, const Pair& values) {
  const Vector by = hn::Set(Floats(), factor);
  sum.low = hn::MulAdd(by, values.low, sum.low);
  sum.high = hn::MulAdd(by, values.high, sum.high);
}

HWY_INLINE void store(const Pair& sum, float* to) {
  const Floats d;
  hn::Store(sum.low, d, to);
  hn::Store(sum.high, d, to + hn::Lanes(d));
}

/// Four rows of the Gram matrix by two vectors at a time: their sums stay in registers.
void add_lanes(const float* HWY_RESTRICT a, float* HWY_RESTRICT gram) {
  const std::size_t step = 2 * hn::Lanes(Floats());
  for (std::size_t k = 0; k < kColumns; k += 4) {
    for (std::size_t j = k / step * step; j < kColumns; j += step) {
      float* const to = gram + k * kColumns + j;
      Pair sum0 = load(to), sum1 = load(to + kColumns), sum2 = load(to + 2 * kColumns),
           sum3 = load(to + 3 * kColumns);
      for (std::size_t row = 0; row < kRows; ++row) {
        const Pair values = load(a + row * kColumns + j);
        const float* const factor = a + row * kColumns + k;
        add(sum0, factor[0], values);
        add(sum1, factor[1], values);
        add(sum2, factor[2], values);
        add(sum3, factor[3], values);
      }
      store(sum0, to);
      store(sum1, to + kColumns);
      store(sum2, to + 2 * kColumns);
      store(sum3, to + 3 * kColumns);
    }
  }
}

}  // namespace rimlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight {

HWY_EXPORT(add_lanes);

void add_gram(const float* a, float* gram) noexcept { HWY_DYNAMIC_DISPATCH(add_lanes)(a, gram); }

}  // namespace rimlight
#endif  // HWY_ONCE
