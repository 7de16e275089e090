// Compiled once for each SIMD target; the one in use is chosen at the first call.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/basis/sh_product_matrix_kernel.cpp"
#include "core/basis/sh_product_matrix_kernel.h"

#include <hwy/foreach_target.h>  // IWYU pragma: keep; before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rimlight {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

constexpr size_t kEntry = ShPackedLight::kEntry;
constexpr size_t kChannels = 3;
/// An entry of the light is one vector of 8, or several of fewer.
using Floats = hn::CappedTag<float, kEntry>;
constexpr size_t kVectors = kEntry / hn::MaxLanes(Floats());

/// Σ C · L along a run, for the cosines and sines of m₃ and all channels.
struct RunSum {
  hn::Vec<Floats> vector[kVectors];
};

/// `values` starts the run in the table, and goes on to the next run.
HWY_INLINE RunSum sum_run(const ShMatrixBuild& build, int l1, int l2, int m3,
                          const float*& values) {
  const Floats floats;
  RunSum sum;
  for (auto& vector : sum.vector) vector = hn::Zero(floats);
  ShTripling::Run run = ShTripling::run(l1, l2, m3);
  const float* value = values;
  values += run.count();
  if (build.first > run.first) {
    const int skipped = (build.first - run.first + 1) / 2;
    value += skipped;
    run.first += 2 * skipped;
  }
  run.last = HWY_MIN(run.last, build.last);
  const float* entry = build.light.values + ShPackedLight::place(build.light.degree, run.first, m3);
  for (int l3 = run.first; l3 <= run.last; l3 += 2, ++value, entry += kEntry) {
    const auto factor = hn::Set(floats, *value);
    for (size_t v = 0; v < kVectors; ++v) {
      sum.vector[v] =
          hn::MulAdd(factor, hn::Load(floats, entry + v * hn::Lanes(floats)), sum.vector[v]);
    }
  }
  return sum;
}

/// One (l, m), m ≥ 0: the rows of its cosine and its sine (none when m = 0).
struct Harmonic {
  size_t cosine, sine;
  bool has_sine;
  Harmonic(int l, int m)
      : cosine(sh_product::place(l, m)), sine(sh_product::place(l, -m)), has_sine(m != 0) {}
};

HWY_INLINE void add_entry(const ShMatrixBuild& build, size_t i, size_t j, const float* rgb) {
  const size_t channel = sh_product::coefficient_count(build.table->degree()) * build.stride;
  float* to = build.matrix + i * build.stride + j;
  for (size_t c = 0; c < kChannels; ++c, to += channel) *to += rgb[c];
}

/// The four products of {cos, sin} m₁φ and {cos, sin} m₂φ from the sums P at m₁ + m₂ and N at
/// |m₁ − m₂|, each {cosine, sine}; s = ±1 is the sign of m₁ − m₂:
///     cos cos: Pc + Nc    sin cos: Ps + s·Ns    sin sin: Nc − Pc    cos sin: Ps − s·Ns
HWY_INLINE void combine(const RunSum& plus, const RunSum& minus, float sign,
                        float* HWY_RESTRICT to) {
  const Floats floats;
  alignas(64) const float first[kEntry] = {1, 1, 1, 1, sign, sign, sign, sign};
  alignas(64) const float second[kEntry] = {1, 1, 1, 1, -1, -1, -1, -1};
  for (size_t v = 0; v < kVectors; ++v) {
    const size_t at = v * hn::Lanes(floats);
    const auto signed_minus = hn::Mul(hn::Load(floats, first + at), minus.vector[v]);
    const auto flip = hn::Load(floats, second + at);
    hn::Store(hn::Add(plus.vector[v], signed_minus), floats, to + at);
    hn::Store(hn::Mul(flip, hn::Sub(signed_minus, plus.vector[v])), floats, to + kEntry + at);
  }
}

/// The entries of row `i` and column `j`, whose sums are to be added at [j][i] too where both are
/// of one degree; below lower degrees that is left to mirror().
HWY_INLINE void add_pair(const ShMatrixBuild& build, const Harmonic& i, const Harmonic& j,
                         bool both_ways, const float* sums) {
  const float* const cos_cos = sums;
  const float* const sin_cos = sums + 4;
  const float* const sin_sin = sums + kEntry;
  const float* const cos_sin = sums + kEntry + 4;
  add_entry(build, i.cosine, j.cosine, cos_cos);
  if (i.has_sine) add_entry(build, i.sine, j.cosine, sin_cos);
  if (j.has_sine) add_entry(build, i.cosine, j.sine, cos_sin);
  if (i.has_sine && j.has_sine) add_entry(build, i.sine, j.sine, sin_sin);
  if (!both_ways) return;
  add_entry(build, j.cosine, i.cosine, cos_cos);
  if (i.has_sine) add_entry(build, j.cosine, i.sine, sin_cos);
  if (j.has_sine) add_entry(build, j.sine, i.cosine, cos_sin);
  if (i.has_sine && j.has_sine) add_entry(build, j.sine, i.sine, sin_sin);
}

/// Rows of (l₁, ±m₁), to the left of the diagonal block and in it.
HWY_INLINE void add_rows(const ShMatrixBuild& build, int l1, int m1, const float*& values) {
  const Harmonic i(l1, m1);
  alignas(64) float sums[2 * kEntry];
  for (int l2 = 0; l2 <= l1; ++l2) {
    const int last = l2 < l1 ? l2 : m1;
    for (int m2 = 0; m2 <= last; ++m2) {
      const RunSum plus = sum_run(build, l1, l2, m1 + m2, values);
      RunSum minus;
      if (m1 != 0 && m2 != 0) {
        minus = sum_run(build, l1, l2, HWY_MAX(m1 - m2, m2 - m1), values);
      } else {
        for (auto& vector : minus.vector) vector = hn::Zero(Floats());
      }
      combine(plus, minus, m1 < m2 ? -1.0f : 1.0f, sums);
      add_pair(build, i, Harmonic(l2, m2), l1 == l2 && m1 != m2, sums);
    }
  }
}

/// Copies what is below the diagonal blocks to above them, a few columns at a time.
void mirror(const ShMatrixBuild& build) {
  const int degree = build.table->degree();
  const size_t size = sh_product::coefficient_count(degree);
  for (size_t channel = 0; channel < kChannels; ++channel) {
    float* const matrix = build.matrix + channel * size * build.stride;
    for (int l = 1; l <= degree; ++l) {
      const size_t begin = sh_product::place(l, -l), end = sh_product::place(l, l) + 1;
      for (size_t j = 0; j < begin; ++j) {
        float* const to = matrix + j * build.stride;
        for (size_t i = begin; i < end; ++i) to[i] = matrix[i * build.stride + j];
      }
    }
  }
}

void build_lanes(const ShMatrixBuild& build) {
  const float* values = build.table->values().data();
  for (int l1 = 0; l1 <= build.table->degree(); ++l1) {
    for (int m1 = 0; m1 <= l1; ++m1) add_rows(build, l1, m1, values);
  }
  mirror(build);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rimlight
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight {

HWY_EXPORT(build_lanes);

void build_product_matrix(const ShMatrixBuild& build) noexcept {
  HWY_DYNAMIC_DISPATCH(build_lanes)(build);
}

}  // namespace rimlight
#endif  // HWY_ONCE
