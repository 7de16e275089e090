#include "core/basis/sh_kernel.h"

#include "core/base/check.h"
#include "core/basis/sh.h"
#include "core/basis/sh_recurrence.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/basis/sh_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rimlight::sh {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using F64 = hn::CappedTag<double, kDirectionLanes / 2>;
using F32 = hn::Rebind<float, F64>;
using V64 = hn::Vec<F64>;
using V32 = hn::Vec<F32>;
constexpr F64 kF64{};
constexpr F32 kF32{};

// Two vectors go together: one recurrence alone would wait for its own last step.
constexpr std::size_t kTogether = 2;
struct Pair {
  V64 part[kTogether];
};

HWY_INLINE Pair load(const float* HWY_RESTRICT from) {
  Pair result;
  for (std::size_t i = 0; i < kTogether; ++i) {
    result.part[i] = hn::PromoteTo(kF64, hn::Load(kF32, from + i * hn::Lanes(kF64)));
  }
  return result;
}

/// 1/√square. Directions that are unit but for a float's rounding need neither the root nor the
/// division: the next term of the series is at most 3/8 · 1e-12.
HWY_INLINE V64 inverse_root(V64 square) {
  const V64 excess = hn::Sub(square, hn::Set(kF64, 1));
  if (HWY_LIKELY(hn::AllTrue(kF64, hn::Lt(hn::Abs(excess), hn::Set(kF64, 1e-6))))) {
    return hn::NegMulAdd(hn::Set(kF64, 0.5), excess, hn::Set(kF64, 1));
  }
  return hn::Div(hn::Set(kF64, 1), hn::Sqrt(square));
}

HWY_INLINE void normalize(Pair& x, Pair& y, Pair& z) {
  for (std::size_t i = 0; i < kTogether; ++i) {
    const V64 scale = inverse_root(hn::MulAdd(
        x.part[i], x.part[i], hn::MulAdd(y.part[i], y.part[i], hn::Mul(z.part[i], z.part[i]))));
    x.part[i] = hn::Mul(x.part[i], scale);
    y.part[i] = hn::Mul(y.part[i], scale);
    z.part[i] = hn::Mul(z.part[i], scale);
  }
}

HWY_INLINE void set(Pair& pair, double value) {
  for (V64& part : pair.part) part = hn::Set(kF64, value);
}

/// (cosine + i·sine) *= x + iy.
HWY_INLINE void turn(Pair& cosine, Pair& sine, const Pair& x, const Pair& y) {
  for (std::size_t i = 0; i < kTogether; ++i) {
    const V64 turned = hn::NegMulAdd(sine.part[i], y.part[i], hn::Mul(cosine.part[i], x.part[i]));
    sine.part[i] = hn::MulAdd(cosine.part[i], y.part[i], hn::Mul(sine.part[i], x.part[i]));
    cosine.part[i] = turned;
  }
}

/// q, before = a·z·q − b·before, q.
HWY_INLINE void advance(Pair& q, Pair& before, const Pair& z, const RecurrenceStep& step) {
  const V64 a = hn::Set(kF64, step.a);
  const V64 b = hn::Set(kF64, step.b);
  for (std::size_t i = 0; i < kTogether; ++i) {
    const V64 next = hn::MulSub(hn::Mul(a, z.part[i]), q.part[i], hn::Mul(b, before.part[i]));
    before.part[i] = q.part[i];
    q.part[i] = next;
  }
}

/// The rows of m and −m at one vector pair of directions; the pointers are to Y_m,±m.
HWY_INLINE void evaluate_order(const Recurrence& table, int m, int degree, const Pair& z,
                               const Pair& cosine, const Pair& sine, std::size_t stride,
                               float* HWY_RESTRICT positive, float* HWY_RESTRICT negative) {
  V32 re[kTogether], im[kTogether];
  for (std::size_t i = 0; i < kTogether; ++i) {
    re[i] = hn::DemoteTo(kF32, cosine.part[i]);
    im[i] = hn::DemoteTo(kF32, sine.part[i]);
  }
  const RecurrenceStep* HWY_RESTRICT step = table.steps_of(m);
  Pair q, before;
  set(q, table.first[static_cast<std::size_t>(m)]);
  set(before, 0);
  for (int l = m;; ++l, ++step) {
    for (std::size_t i = 0; i < kTogether; ++i) {
      const V32 rounded = hn::DemoteTo(kF32, q.part[i]);
      hn::Store(hn::Mul(rounded, re[i]), kF32, positive + i * hn::Lanes(kF64));
      hn::Store(hn::Mul(rounded, im[i]), kF32, negative + i * hn::Lanes(kF64));
    }
    if (l == degree) break;
    advance(q, before, z, *step);
    const std::size_t down = static_cast<std::size_t>(2 * l + 2) * stride;
    positive += down;
    negative += down;
  }
}

/// The rows of m = 0: the second is `down` floats after the first, each next one `rise` further.
HWY_INLINE void evaluate_axial(const Recurrence& table, int degree, const Pair& z, std::size_t down,
                               std::size_t rise, float* HWY_RESTRICT values) {
  const RecurrenceStep* HWY_RESTRICT step = table.steps_of(0);
  Pair q, before;
  set(q, table.first[0]);
  set(before, 0);
  for (int l = 0;; ++l, ++step) {
    for (std::size_t i = 0; i < kTogether; ++i) {
      hn::Store(hn::DemoteTo(kF32, q.part[i]), kF32, values + i * hn::Lanes(kF64));
    }
    if (l == degree) break;
    advance(q, before, z, *step);
    values += down;
    down += rise;
  }
}

void evaluate_lanes(const DirectionSpans& directions, int degree, float* HWY_RESTRICT values,
                    std::size_t stride) {
  const Recurrence& table = recurrence();
  for (std::size_t first = 0; first < directions.x.size(); first += kTogether * hn::Lanes(kF64)) {
    Pair x = load(directions.x.data() + first);
    Pair y = load(directions.y.data() + first);
    Pair z = load(directions.z.data() + first);
    normalize(x, y, z);
    evaluate_axial(table, degree, z, 2 * stride, 2 * stride, values + first);
    Pair cosine = x, sine = y;
    for (int m = 1; m <= degree; ++m) {
      evaluate_order(table, m, degree, z, cosine, sine, stride,
                     values + index(m, m) * stride + first, values + index(m, -m) * stride + first);
      turn(cosine, sine, x, y);
    }
  }
}

void evaluate_zonal_lanes(std::span<const float> cosines, int degree, float* HWY_RESTRICT values,
                          std::size_t stride) {
  const Recurrence& table = recurrence();
  for (std::size_t first = 0; first < cosines.size(); first += kTogether * hn::Lanes(kF64)) {
    evaluate_axial(table, degree, load(cosines.data() + first), stride, 0, values + first);
  }
}

const char* target_name() { return hwy::TargetName(HWY_TARGET); }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rimlight::sh
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight::sh {

HWY_EXPORT(evaluate_lanes);
HWY_EXPORT(evaluate_zonal_lanes);
HWY_EXPORT(target_name);

namespace {
void check_shape(std::size_t directions, std::size_t rows, std::size_t values, std::size_t stride) {
  RIMLIGHT_CHECK_EQ(directions % kDirectionLanes, std::size_t{0});
  RIMLIGHT_CHECK_EQ(stride % kDirectionLanes, std::size_t{0});
  RIMLIGHT_CHECK(directions <= stride);
  RIMLIGHT_CHECK_EQ(values, rows * stride);
}
}  // namespace

void evaluate(const DirectionSpans& directions, int degree, std::span<float> values,
              std::size_t stride) {
  check_degree(degree);
  RIMLIGHT_CHECK_EQ(directions.y.size(), directions.x.size());
  RIMLIGHT_CHECK_EQ(directions.z.size(), directions.x.size());
  check_shape(directions.x.size(), coefficient_count(degree), values.size(), stride);
  HWY_DYNAMIC_DISPATCH(evaluate_lanes)(directions, degree, values.data(), stride);
}

void evaluate_zonal(std::span<const float> cosines, int degree, std::span<float> values,
                    std::size_t stride) {
  check_degree(degree);
  check_shape(cosines.size(), static_cast<std::size_t>(degree) + 1, values.size(), stride);
  HWY_DYNAMIC_DISPATCH(evaluate_zonal_lanes)(cosines, degree, values.data(), stride);
}

const char* kernel_target() { return HWY_DYNAMIC_DISPATCH(target_name)(); }

}  // namespace rimlight::sh
#endif  // HWY_ONCE
