#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/core/basis/peak_flops.cpp"
#include "bench/core/basis/peak_flops.h"

#include <benchmark/benchmark.h>

#include <hwy/foreach_target.h>  // IWYU pragma: keep; before highway.h
#include <hwy/highway.h>

#include <algorithm>

#include "core/base/stopwatch.h"

HWY_BEFORE_NAMESPACE();
namespace rimlight {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

/// Chains enough to hide the latency of two units, few enough for 16 registers.
constexpr size_t kChains = 10;
constexpr size_t kSteps = 100000;

double flops_of_one_run() {
  const hn::CappedTag<float, 16> floats;
  auto factor = hn::Set(floats, 0.999999f), term = hn::Set(floats, 1e-7f);
  benchmark::DoNotOptimize(factor);
  benchmark::DoNotOptimize(term);
  hn::Vec<decltype(floats)> sum[kChains];
  for (auto& chain : sum) chain = factor;
  const Stopwatch watch;
  for (size_t step = 0; step < kSteps; ++step) {
    for (auto& chain : sum) chain = hn::MulAdd(chain, factor, term);
  }
  for (auto& chain : sum) benchmark::DoNotOptimize(chain);
  return 2.0 * static_cast<double>(kSteps * kChains * hn::Lanes(floats)) / watch.elapsed_seconds();
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rimlight
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight {

HWY_EXPORT(flops_of_one_run);

double peak_flops() {
  double best = 0;
  for (int i = 0; i < 10; ++i) best = std::max(best, HWY_DYNAMIC_DISPATCH(flops_of_one_run)());
  return best;
}

}  // namespace rimlight
#endif  // HWY_ONCE
