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
constexpr size_t kPixel = ShMatrixBuild::kPixel;
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

/// The four products of {cos, sin} m₁φ and {cos, sin} m₂φ from the sums P at m₁ + m₂ and N at
/// |m₁ − m₂|, each {cosine, sine}; s = ±1 is the sign of m₁ − m₂:
///     cos cos: Pc + Nc    sin cos: Ps + s·Ns    sin sin: Nc − Pc    cos sin: Ps − s·Ns
/// `to`: cos cos, sin cos, sin sin, cos sin, each R, G, B, 0.
HWY_INLINE void combine(const RunSum& plus, const RunSum& minus, bool negative,
                        float* HWY_RESTRICT to) {
  alignas(64) static constexpr float kSign[2][kEntry] = {{1, 1, 1, 1, 1, 1, 1, 1},
                                                         {1, 1, 1, 1, -1, -1, -1, -1}};
  const Floats floats;
  for (size_t v = 0; v < kVectors; ++v) {
    const size_t at = v * hn::Lanes(floats);
    const auto signed_minus = hn::Mul(hn::Load(floats, kSign[negative] + at), minus.vector[v]);
    const auto difference = hn::Sub(signed_minus, plus.vector[v]);
    hn::Store(hn::Add(plus.vector[v], signed_minus), floats, to + at);
    hn::Store(hn::Mul(hn::Load(floats, kSign[1] + at), difference), floats, to + kEntry + at);
  }
}

/// Rows of (l₁, ±m₁), to the left of the diagonal block and in it: first as [column][R, G, B, 0],
/// as they come, the row of the cosine and, `build.stride` columns on, that of the sine.
HWY_INLINE void sum_rows(const ShMatrixBuild& build, int l1, int m1, const float*& values) {
  const auto column = [&](size_t row, int l2, int m2) {
    return build.rows + kPixel * (row * build.stride + sh::index(l2, m2));
  };
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
      combine(plus, minus, m1 < m2, sums);
      hwy::CopyBytes<sizeof(float) * kPixel>(sums, column(0, l2, m2));
      hwy::CopyBytes<sizeof(float) * kPixel>(sums + kPixel, column(1, l2, m2));
      if (m2 == 0) continue;
      hwy::CopyBytes<sizeof(float) * kPixel>(sums + 2 * kPixel, column(1, l2, -m2));
      hwy::CopyBytes<sizeof(float) * kPixel>(sums + 3 * kPixel, column(0, l2, -m2));
    }
  }
}

/// A row of sums to row i of the channels. What is right of the diagonal block, and of the diagonal
/// block where |m₂| > |m₁|, is left over from earlier rows; mirror() writes there.
HWY_INLINE void finish_row(const ShMatrixBuild& build, size_t i, size_t end, const float* sums) {
  const hn::CappedTag<float, 16> floats;
  const size_t channel = sh::coefficient_count(build.table->degree()) * build.stride;
  float* const to = build.matrix + i * build.stride;
  for (size_t j = 0; j < end; j += hn::Lanes(floats)) {
    auto red = hn::Undefined(floats), green = red, blue = red, unused = red;
    hn::LoadInterleaved4(floats, sums + kPixel * j, red, green, blue, unused);
    if (build.adds) {
      red = hn::Add(red, hn::Load(floats, to + j));
      green = hn::Add(green, hn::Load(floats, to + channel + j));
      blue = hn::Add(blue, hn::Load(floats, to + 2 * channel + j));
    }
    hn::Store(red, floats, to + j);
    hn::Store(green, floats, to + channel + j);
    hn::Store(blue, floats, to + 2 * channel + j);
  }
}

/// What is known from rows below, or of a larger |m| in the same degree, to where it is missing.
void mirror(const ShMatrixBuild& build, float* matrix) {
  for (int l = 1; l <= build.table->degree(); ++l) {
    const size_t begin = sh::index(l, -l), end = sh::index(l, l) + 1;
    for (size_t j = 0; j < begin; ++j) {
      float* const to = matrix + j * build.stride;
      for (size_t i = begin; i < end; ++i) to[i] = matrix[i * build.stride + j];
    }
    const size_t zonal = sh::index(l, 0);
    for (size_t m = 0; m < zonal - begin; ++m) {
      for (size_t j = zonal - m; j <= zonal + m; ++j) {
        for (const size_t i : {zonal - m - 1, zonal + m + 1}) {
          matrix[j * build.stride + i] = matrix[i * build.stride + j];
        }
      }
    }
  }
}

void build_lanes(const ShMatrixBuild& build) {
  const float* values = build.table->values().data();
  for (int l = 0; l <= build.table->degree(); ++l) {
    const size_t end = sh::coefficient_count(l);
    for (int m = 0; m <= l; ++m) {
      sum_rows(build, l, m, values);
      finish_row(build, sh::index(l, m), end, build.rows);
      if (m == 0) continue;
      finish_row(build, sh::index(l, -m), end, build.rows + kPixel * build.stride);
    }
  }
  const size_t size = sh::coefficient_count(build.table->degree());
  for (size_t channel = 0; channel < kChannels; ++channel) {
    mirror(build, build.matrix + channel * size * build.stride);
  }
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
