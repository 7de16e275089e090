// Compiled once for each SIMD target; the one in use is chosen at the first call.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/curves/curve_column_kernel.cpp"
#include "core/curves/curve_column_kernel.h"

#include <hwy/cache_control.h>
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

/// One channel of four vectors of rows, whose sums stay in registers: with 16 lanes, all rows, so
/// that a column is read in one go.
struct Quad {
  Vector first, second, third, fourth;
};

HWY_INLINE void add(Quad& sum, float factor, const std::int16_t* from) {
  const Floats d;
  const std::size_t lanes = hn::Lanes(d);
  const Vector by = hn::Set(d, factor);
  sum.first = hn::MulAdd(by, load_numbers(from), sum.first);
  sum.second = hn::MulAdd(by, load_numbers(from + lanes), sum.second);
  sum.third = hn::MulAdd(by, load_numbers(from + 2 * lanes), sum.third);
  sum.fourth = hn::MulAdd(by, load_numbers(from + 3 * lanes), sum.fourth);
}

HWY_INLINE Quad load(const float* from) {
  const Floats d;
  const std::size_t lanes = hn::Lanes(d);
  return {hn::Load(d, from), hn::Load(d, from + lanes), hn::Load(d, from + 2 * lanes),
          hn::Load(d, from + 3 * lanes)};
}

HWY_INLINE void store(const Quad& sum, float* to) {
  const Floats d;
  const std::size_t lanes = hn::Lanes(d);
  hn::Store(sum.first, d, to);
  hn::Store(sum.second, d, to + lanes);
  hn::Store(sum.third, d, to + 2 * lanes);
  hn::Store(sum.fourth, d, to + 3 * lanes);
}

/// Columns ahead of the one that is added whose memory is asked for.
constexpr std::size_t kAhead = 8;

void add_lanes(const std::int16_t* HWY_RESTRICT numbers, const float* HWY_RESTRICT steps,
               const CurveColumn* HWY_RESTRICT columns, std::size_t count,
               float* HWY_RESTRICT image) {
  const std::size_t step = 4 * hn::Lanes(Floats());
  for (std::size_t lane = 0; lane < kRows; lane += step) {
    Quad red = load(image + lane), green = load(image + kRows + lane),
         blue = load(image + 2 * kRows + lane);
    for (std::size_t i = 0; i < count; ++i) {
      if (lane == 0 && i + kAhead < count) {
        const std::int16_t* const next = numbers + columns[i + kAhead].coefficient * 3 * kRows;
        for (std::size_t line = 0; line < 3 * kRows; line += 32) hwy::Prefetch(next + line);
      }
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
