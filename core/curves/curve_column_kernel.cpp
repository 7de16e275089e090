// Compiled once for each SIMD target; the one in use is chosen at the first call.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/curves/curve_column_kernel.cpp"
#include "core/curves/curve_column_kernel.h"

#include <hwy/foreach_target.h>  // IWYU pragma: keep; before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rimlight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 16>;
using Vector = hn::Vec<Floats>;

constexpr std::size_t kRows = 64;

HWY_INLINE Vector load_numbers(const std::int16_t* from) {
  const Floats d;
  const hn::Rebind<std::int16_t, Floats> shorts;
  const hn::RebindToSigned<Floats> whole;
  return hn::ConvertTo(d, hn::PromoteTo(whole, hn::Load(shorts, from)));
}

/// One channel of all columns for two vectors of rows, whose sums stay in registers.
struct Pair {
  Vector low, high;
};

HWY_INLINE void add(Pair& sum, float factor, const std::int16_t* from) {
  const Floats d;
  const Vector by = hn::Set(d, factor);
  sum.low = hn::MulAdd(by, load_numbers(from), sum.low);
  sum.high = hn::MulAdd(by, load_numbers(from + hn::Lanes(d)), sum.high);
}

HWY_INLINE Pair load(const float* from) {
  const Floats d;
  return {hn::Load(d, from), hn::Load(d, from + hn::Lanes(d))};
}

HWY_INLINE void store(const Pair& sum, float* to) {
  const Floats d;
  hn::Store(sum.low, d, to);
  hn::Store(sum.high, d, to + hn::Lanes(d));
}

void add_lanes(const std::int16_t* HWY_RESTRICT numbers, const float* HWY_RESTRICT steps,
               const CurveColumn* HWY_RESTRICT columns, std::size_t count,
               float* HWY_RESTRICT image) {
  const std::size_t step = 2 * hn::Lanes(Floats());
  for (std::size_t lane = 0; lane < kRows; lane += step) {
    Pair red = load(image + lane), green = load(image + kRows + lane),
         blue = load(image + 2 * kRows + lane);
    for (std::size_t i = 0; i < count; ++i) {
      const CurveColumn& column = columns[i];
      const std::int16_t* const from = numbers + column.coefficient * 3 * kRows + lane;
      const float* const scale = steps + column.coefficient * 3;
      add(red, column.delta.x * scale[0], from);
      add(green, column.delta.y * scale[1], from + kRows);
      add(blue, column.delta.z * scale[2], from + 2 * kRows);
    }
    store(red, image + lane);
    store(green, image + kRows + lane);
    store(blue, image + 2 * kRows + lane);
  }
}

}  // namespace rimlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight {

HWY_EXPORT(add_lanes);

void add_curve_columns(const std::int16_t* numbers, const float* steps,
                       std::span<const CurveColumn> columns, float* image) noexcept {
  HWY_DYNAMIC_DISPATCH(add_lanes)(numbers, steps, columns.data(), columns.size(), image);
}

}  // namespace rimlight
#endif  // HWY_ONCE
