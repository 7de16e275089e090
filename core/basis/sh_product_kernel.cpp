// Compiled once for each SIMD target; the one in use is chosen at the first call.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/basis/sh_product_kernel.cpp"
#include "core/basis/sh_product_kernel.h"

#include <hwy/foreach_target.h>  // IWYU pragma: keep; before highway.h
#include <hwy/highway.h>

#include "core/basis/sh_product.h"

HWY_BEFORE_NAMESPACE();
namespace rimlight {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, ShProduct::kLaneMultiple>;
using Matrix = ShGridTransform::Matrix;
constexpr size_t kKinds = ShGridTransform::kKinds;

/// out[row] = Σ_c a[c][row] · in[c], vectors of receivers; the sums stay in registers.
template <size_t kRows>
HWY_INLINE void apply_block(const float* HWY_RESTRICT a, size_t columns,
                            const float* HWY_RESTRICT in, float* HWY_RESTRICT out) {
  const Floats floats;
  const size_t lanes = hn::Lanes(floats);
  hn::Vec<Floats> sum[kRows];
  for (size_t row = 0; row < kRows; ++row) sum[row] = hn::Zero(floats);
  for (size_t c = 0; c < columns; ++c, a += kRows, in += lanes) {
    const auto value = hn::Load(floats, in);
    for (size_t row = 0; row < kRows; ++row) {
      sum[row] = hn::MulAdd(hn::Set(floats, a[row]), value, sum[row]);
    }
  }
  for (size_t row = 0; row < kRows; ++row) hn::Store(sum[row], floats, out + row * lanes);
}

/// out = matrix · in, vectors one after another in both.
HWY_INLINE void apply(const ShGridTransform& transform, const Matrix& matrix, const float* in,
                      float* out) {
  const size_t lanes = hn::Lanes(Floats());
  const float* a = transform.values.data() + matrix.first;
  size_t rows = matrix.rows;
  for (; rows >= 8; rows -= 8, a += 8 * matrix.columns, out += 8 * lanes) {
    apply_block<8>(a, matrix.columns, in, out);
  }
  switch (rows) {
    case 7:
      return apply_block<7>(a, matrix.columns, in, out);
    case 6:
      return apply_block<6>(a, matrix.columns, in, out);
    case 5:
      return apply_block<5>(a, matrix.columns, in, out);
    case 4:
      return apply_block<4>(a, matrix.columns, in, out);
    case 3:
      return apply_block<3>(a, matrix.columns, in, out);
    case 2:
      return apply_block<2>(a, matrix.columns, in, out);
    case 1:
      return apply_block<1>(a, matrix.columns, in, out);
    default:
      return;
  }
}

/// Where one vector of receivers is worked on; sizes as in ShProductPlan::workspace_size().
struct Scratch {
  float* first;  // [2 count][columns]: the northern latitudes, then their southern mirrors
  float* second;
  float* product;
  float* kinds[2];   // [kind][count], of the first and the second function
  float* halves;     // [2][count]
  float* harmonics;  // of one column
};

/// Coefficients to columns at all latitudes.
HWY_INLINE void to_latitudes(const ShGridTransform& transform, const float* coefficients,
                             size_t stride, size_t count, const Scratch& scratch, float* to) {
  const Floats floats;
  const size_t lanes = hn::Lanes(floats);
  const size_t columns = transform.columns.size();
  for (size_t c = 0; c < columns; ++c) {
    const ShGridTransform::Column& column = transform.columns[c];
    const size_t even = column.half[0].columns;
    const size_t* const places = transform.places.data() + column.first;
    for (size_t i = 0; i < even + column.half[1].columns; ++i) {
      hn::Store(hn::LoadU(floats, coefficients + places[i] * stride), floats,
                scratch.harmonics + i * lanes);
    }
    apply(transform, column.half[0], scratch.harmonics, scratch.halves);
    apply(transform, column.half[1], scratch.harmonics + even * lanes,
          scratch.halves + count * lanes);
    for (size_t i = 0; i < count; ++i) {
      const auto same = hn::Load(floats, scratch.halves + i * lanes);
      const auto negated = hn::Load(floats, scratch.halves + (count + i) * lanes);
      hn::Store(hn::Add(same, negated), floats, to + (i * columns + c) * lanes);
      hn::Store(hn::Sub(same, negated), floats, to + ((count + i) * columns + c) * lanes);
    }
  }
}

/// The transpose: columns at all latitudes to coefficients.
HWY_INLINE void from_latitudes(const ShGridTransform& transform, const float* from, size_t count,
                               const Scratch& scratch, float* coefficients, size_t stride) {
  const Floats floats;
  const size_t lanes = hn::Lanes(floats);
  const size_t columns = transform.columns.size();
  for (size_t c = 0; c < columns; ++c) {
    const ShGridTransform::Column& column = transform.columns[c];
    for (size_t i = 0; i < count; ++i) {
      const auto north = hn::Load(floats, from + (i * columns + c) * lanes);
      const auto south = hn::Load(floats, from + ((count + i) * columns + c) * lanes);
      hn::Store(hn::Add(north, south), floats, scratch.halves + i * lanes);
      hn::Store(hn::Sub(north, south), floats, scratch.halves + (count + i) * lanes);
    }
    const size_t even = column.half[0].rows;
    apply(transform, column.half[0], scratch.halves, scratch.harmonics);
    apply(transform, column.half[1], scratch.halves + count * lanes,
          scratch.harmonics + even * lanes);
    const size_t* const places = transform.places.data() + column.first;
    for (size_t i = 0; i < even + column.half[1].rows; ++i) {
      hn::StoreU(hn::Load(floats, scratch.harmonics + i * lanes), floats,
                 coefficients + places[i] * stride);
    }
  }
}

/// One latitude's columns to the four kinds' sums at a quarter turn.
HWY_INLINE void to_azimuths(const ShGridTransform& transform, const float* columns, size_t count,
                            float* kinds) {
  const size_t lanes = hn::Lanes(Floats());
  for (size_t kind = 0; kind < kKinds; ++kind) {
    apply(transform, transform.azimuths[kind], columns, kinds + kind * count * lanes);
    columns += transform.kind_columns[kind] * lanes;
  }
}

/// Values at φ, π − φ, π + φ and −φ from the kinds cos even, cos odd, sin even, sin odd at φ; and
/// the transpose, since the matrix of signs is
///     + + + +        cos mφ has the sign of (−1)^m at π − φ and π + φ,
///     + − − +        sin mφ that of −(−1)^m at π − φ, (−1)^m at π + φ, − at −φ
///     + − + −
///     + + − −
template <class V>
HWY_INLINE void mirror(V& a, V& b, V& c, V& d) {
  const V cosines = hn::Add(a, b), other_cosines = hn::Sub(a, b);
  const V sines = hn::Add(c, d), other_sines = hn::Sub(c, d);
  a = hn::Add(cosines, sines);
  b = hn::Sub(other_cosines, other_sines);
  c = hn::Add(other_cosines, other_sines);
  d = hn::Sub(cosines, sines);
}
template <class V>
HWY_INLINE void mirror_back(V& a, V& b, V& c, V& d) {
  const V outer = hn::Add(a, d), inner = hn::Add(b, c);
  const V outer_difference = hn::Sub(a, d), inner_difference = hn::Sub(c, b);
  a = hn::Add(outer, inner);
  b = hn::Sub(outer, inner);
  c = hn::Add(outer_difference, inner_difference);
  d = hn::Sub(outer_difference, inner_difference);
}

/// The product around one latitude, from both functions' kinds back to kinds, in place of the
/// first.
HWY_INLINE void multiply_around(size_t count, float* HWY_RESTRICT first,
                                const float* HWY_RESTRICT second) {
  const Floats floats;
  const size_t step = count * hn::Lanes(floats);
  for (size_t i = 0; i < step; i += hn::Lanes(floats)) {
    auto a = hn::Load(floats, first + i), b = hn::Load(floats, first + step + i);
    auto c = hn::Load(floats, first + 2 * step + i), d = hn::Load(floats, first + 3 * step + i);
    mirror(a, b, c, d);
    auto e = hn::Load(floats, second + i), f = hn::Load(floats, second + step + i);
    auto g = hn::Load(floats, second + 2 * step + i), h = hn::Load(floats, second + 3 * step + i);
    mirror(e, f, g, h);
    a = hn::Mul(a, e);
    b = hn::Mul(b, f);
    c = hn::Mul(c, g);
    d = hn::Mul(d, h);
    mirror_back(a, b, c, d);
    hn::Store(a, floats, first + i);
    hn::Store(b, floats, first + step + i);
    hn::Store(c, floats, first + 2 * step + i);
    hn::Store(d, floats, first + 3 * step + i);
  }
}

Scratch divide(const ShProductPlan& plan, float* workspace) {
  const size_t lanes = hn::Lanes(Floats()), latitudes = 2 * plan.count * lanes;
  Scratch scratch;
  scratch.first = workspace;
  scratch.second = scratch.first + latitudes * plan.first.columns.size();
  scratch.product = scratch.second + latitudes * plan.second.columns.size();
  scratch.kinds[0] = scratch.product + latitudes * plan.product.columns.size();
  scratch.kinds[1] = scratch.kinds[0] + kKinds * plan.count * lanes;
  scratch.halves = scratch.kinds[1] + kKinds * plan.count * lanes;
  scratch.harmonics = scratch.halves + 2 * plan.count * lanes;
  return scratch;
}

void multiply_lanes(const ShProductPlan& plan, const ShProductArrays& arrays) {
  const size_t lanes = hn::Lanes(Floats()), count = plan.count;
  const Scratch scratch = divide(plan, arrays.workspace);
  for (size_t lane = 0; lane < arrays.lanes; lane += lanes) {
    to_latitudes(plan.first, arrays.first + lane, arrays.lanes, count, scratch, scratch.first);
    to_latitudes(plan.second, arrays.second + lane, arrays.lanes, count, scratch, scratch.second);
    for (size_t i = 0; i < 2 * count; ++i) {
      to_azimuths(plan.first, scratch.first + i * plan.first.columns.size() * lanes, count,
                  scratch.kinds[0]);
      to_azimuths(plan.second, scratch.second + i * plan.second.columns.size() * lanes, count,
                  scratch.kinds[1]);
      multiply_around(count, scratch.kinds[0], scratch.kinds[1]);
      float* to = scratch.product + i * plan.product.columns.size() * lanes;
      for (size_t kind = 0; kind < kKinds; ++kind) {
        apply(plan.product, plan.product.azimuths[kind], scratch.kinds[0] + kind * count * lanes,
              to);
        to += plan.product.kind_columns[kind] * lanes;
      }
    }
    from_latitudes(plan.product, scratch.product, count, scratch, arrays.product + lane,
                   arrays.lanes);
  }
}

const char* target_name() { return hwy::TargetName(HWY_TARGET); }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rimlight
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight {

HWY_EXPORT(multiply_lanes);
HWY_EXPORT(target_name);

void multiply_harmonics(const ShProductPlan& plan, const ShProductArrays& arrays) noexcept {
  HWY_DYNAMIC_DISPATCH(multiply_lanes)(plan, arrays);
}

const char* sh_product_target() { return HWY_DYNAMIC_DISPATCH(target_name)(); }

}  // namespace rimlight
#endif  // HWY_ONCE
