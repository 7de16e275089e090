// Compiled once for each SIMD target; the one in use is chosen at the first call.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/report/fma_peak.cpp"
#include "core/report/fma_peak.h"

#include <hwy/foreach_target.h>  // IWYU pragma: keep; before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <atomic>

#include "core/base/parallel.h"
#include "core/base/stopwatch.h"

HWY_BEFORE_NAMESPACE();
namespace rimlight {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

// More chains than latency (4 or 5 cycles) × ports (2) in flight.
constexpr size_t kChains = 12;

/// Runs `steps` FMAs on each chain; returns their sum, so that none is left out.
float run_fmas(size_t steps) {
  const hn::ScalableTag<float> floats;
  hn::Vec<decltype(floats)> chain[kChains];
  for (size_t i = 0; i < kChains; ++i) chain[i] = hn::Set(floats, static_cast<float>(i));
  const auto scale = hn::Set(floats, 0.999f), shift = hn::Set(floats, 1e-3f);
  for (size_t step = 0; step < steps; ++step) {
    for (auto& value : chain) value = hn::MulAdd(value, scale, shift);
  }
  auto sum = chain[0];
  for (size_t i = 1; i < kChains; ++i) sum = hn::Add(sum, chain[i]);
  return hn::GetLane(hn::SumOfLanes(floats, sum));
}

size_t operations_a_step() { return 2 * kChains * hn::Lanes(hn::ScalableTag<float>()); }

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rimlight
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight {

HWY_EXPORT(run_fmas);
HWY_EXPORT(operations_a_step);

double fma_peak() {
  constexpr std::size_t kSteps = 20000, kPartsOfThread = 4;
  constexpr int kRuns = 4;
  const std::size_t parts = kPartsOfThread * static_cast<std::size_t>(thread_count());
  const auto operations =
      static_cast<double>(parts * kSteps * HWY_DYNAMIC_DISPATCH(operations_a_step)());
  std::atomic<float> kept{0};
  double best = 0;
  for (int run = 0; run < kRuns; ++run) {
    const Stopwatch watch;
    parallel_for(parts, [&kept](std::size_t) { kept = HWY_DYNAMIC_DISPATCH(run_fmas)(kSteps); });
    best = std::max(best, operations / watch.elapsed_seconds());
  }
  return best;
}

}  // namespace rimlight
#endif  // HWY_ONCE
