#include "core/basis/sh_sum_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/basis/sh_sum_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rimlight::sh {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using F32 = hn::CappedTag<float, 16>;
using V = hn::Vec<F32>;
constexpr F32 kF32{};

/// kSignals at once, so that each value of the basis is read once for them.
template <int kSignals>
HWY_INLINE void add_projection_of(const BasisBlock& block, const float* HWY_RESTRICT samples,
                                  double* HWY_RESTRICT sums) {
  const float* HWY_RESTRICT row = block.values;
  for (std::size_t c = 0; c < block.coefficients; ++c, row += block.stride) {
    V sum[kSignals];
    for (V& one : sum) one = hn::Zero(kF32);
    for (std::size_t d = 0; d < block.directions; d += hn::Lanes(kF32)) {
      const V value = hn::Load(kF32, row + d);
      for (std::size_t s = 0; s < kSignals; ++s) {
        sum[s] = hn::MulAdd(value, hn::Load(kF32, samples + s * block.stride + d), sum[s]);
      }
    }
    for (std::size_t s = 0; s < kSignals; ++s) {
      sums[s * block.coefficients + c] +=
          static_cast<double>(hn::GetLane(hn::SumOfLanes(kF32, sum[s])));
    }
  }
}

template <int kSignals>
HWY_INLINE void sum_basis_of(const BasisBlock& block, const float* HWY_RESTRICT coefficients,
                             float* HWY_RESTRICT samples) {
  // Two vectors of directions: the FMAs of one signal alone would wait for each other.
  constexpr std::size_t kTogether = 2;
  const std::size_t lanes = hn::Lanes(kF32);
  for (std::size_t d = 0; d < block.directions; d += kTogether * lanes) {
    // The last one again where there is no second.
    const std::size_t second = d + lanes < block.directions ? d + lanes : d;
    V sum[kSignals][kTogether];
    for (auto& of_signal : sum) {
      for (V& one : of_signal) one = hn::Zero(kF32);
    }
    const float* HWY_RESTRICT row = block.values;
    for (std::size_t c = 0; c < block.coefficients; ++c, row += block.stride) {
      const V value[kTogether] = {hn::Load(kF32, row + d), hn::Load(kF32, row + second)};
      for (std::size_t s = 0; s < kSignals; ++s) {
        const V factor = hn::Set(kF32, coefficients[s * block.coefficients + c]);
        for (std::size_t i = 0; i < kTogether; ++i) {
          sum[s][i] = hn::MulAdd(factor, value[i], sum[s][i]);
        }
      }
    }
    for (std::size_t s = 0; s < kSignals; ++s) {
      hn::Store(sum[s][0], kF32, samples + s * block.stride + d);
      hn::Store(sum[s][1], kF32, samples + s * block.stride + second);
    }
  }
}

void add_projection_lanes(const BasisBlock& block, const float* samples, std::size_t signals,
                          double* sums) {
  std::size_t s = 0;
  for (; s + 3 <= signals; s += 3) {
    add_projection_of<3>(block, samples + s * block.stride, sums + s * block.coefficients);
  }
  for (; s < signals; ++s) {
    add_projection_of<1>(block, samples + s * block.stride, sums + s * block.coefficients);
  }
}

void sum_basis_lanes(const BasisBlock& block, const float* coefficients, std::size_t signals,
                     float* samples) {
  std::size_t s = 0;
  for (; s + 3 <= signals; s += 3) {
    sum_basis_of<3>(block, coefficients + s * block.coefficients, samples + s * block.stride);
  }
  for (; s < signals; ++s) {
    sum_basis_of<1>(block, coefficients + s * block.coefficients, samples + s * block.stride);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rimlight::sh
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight::sh {

HWY_EXPORT(add_projection_lanes);
HWY_EXPORT(sum_basis_lanes);

void add_projection(const BasisBlock& block, const float* samples, std::size_t signals,
                    double* sums) noexcept {
  HWY_DYNAMIC_DISPATCH(add_projection_lanes)(block, samples, signals, sums);
}

void sum_basis(const BasisBlock& block, const float* coefficients, std::size_t signals,
               float* samples) noexcept {
  HWY_DYNAMIC_DISPATCH(sum_basis_lanes)(block, coefficients, signals, samples);
}

}  // namespace rimlight::sh
#endif  // HWY_ONCE
