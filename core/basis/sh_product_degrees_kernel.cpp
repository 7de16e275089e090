// Compiled once for each SIMD target; the one in use is chosen at the first call.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/basis/sh_product_degrees_kernel.cpp"
#include "core/basis/sh_product_degrees_kernel.h"

#include <hwy/foreach_target.h>  // IWYU pragma: keep; before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rimlight {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
/// Rows whose sums are in registers at once, by two vectors of receivers: 32 registers hold 12 × 2
/// sums, 16 hold 6 × 2, with room for the factors.
constexpr size_t kMostRows = hn::MaxLanes(Floats()) == 16 ? 12 : 6;

template <size_t kRows, size_t kVectors>
HWY_INLINE void add_block(const ShMatrixProduct& whole, size_t row, const ShIndexRange& columns,
                          size_t lane) {
  const Floats floats;
  const size_t lanes = hn::Lanes(floats);
  float* const HWY_RESTRICT to = whole.product + row * whole.lanes + lane;
  hn::Vec<Floats> sum[kRows][kVectors];
  for (size_t r = 0; r < kRows; ++r) {
    for (size_t v = 0; v < kVectors; ++v) {
      sum[r][v] = hn::LoadU(floats, to + r * whole.lanes + v * lanes);
    }
  }
  // By symmetry the factors of neighbouring rows lie side by side, in row j.
  const float* factor = whole.matrix + columns.begin * whole.stride + row;
  const float* from = whole.transport + columns.begin * whole.lanes + lane;
  for (size_t j = columns.begin; j < columns.end; ++j) {
    hn::Vec<Floats> value[kVectors];
    for (size_t v = 0; v < kVectors; ++v) value[v] = hn::LoadU(floats, from + v * lanes);
    for (size_t r = 0; r < kRows; ++r) {
      const auto all = hn::Set(floats, factor[r]);
      for (size_t v = 0; v < kVectors; ++v) sum[r][v] = hn::MulAdd(all, value[v], sum[r][v]);
    }
    factor += whole.stride;
    from += whole.lanes;
  }
  for (size_t r = 0; r < kRows; ++r) {
    for (size_t v = 0; v < kVectors; ++v) {
      hn::StoreU(sum[r][v], floats, to + r * whole.lanes + v * lanes);
    }
  }
}

template <size_t kVectors>
HWY_INLINE void add_rows(const ShMatrixProduct& whole, const ShIndexRange& rows,
                         const ShIndexRange& columns, size_t lane) {
  size_t row = rows.begin;
  for (; row + kMostRows <= rows.end; row += kMostRows) {
    add_block<kMostRows, kVectors>(whole, row, columns, lane);
  }
  for (; row + 4 <= rows.end; row += 4) add_block<4, kVectors>(whole, row, columns, lane);
  for (; row < rows.end; ++row) add_block<1, kVectors>(whole, row, columns, lane);
}

void add_lanes(const ShMatrixProduct& whole, const ShIndexRange& rows,
               const ShIndexRange& columns) {
  const size_t lanes = hn::Lanes(Floats());
  size_t lane = 0;
  for (; lane + 2 * lanes <= whole.lanes; lane += 2 * lanes) {
    add_rows<2>(whole, rows, columns, lane);
  }
  for (; lane < whole.lanes; lane += lanes) add_rows<1>(whole, rows, columns, lane);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rimlight
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight {

HWY_EXPORT(add_lanes);

void add_matrix_product(const ShMatrixProduct& whole, const ShIndexRange& rows,
                        const ShIndexRange& columns) noexcept {
  HWY_DYNAMIC_DISPATCH(add_lanes)(whole, rows, columns);
}

}  // namespace rimlight
#endif  // HWY_ONCE
