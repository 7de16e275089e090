#include "bench/support/peak_flops.h"

#include <algorithm>
#include <chrono>
#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/support/peak_flops.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rimlight::bench {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// More chains than latency (4 or 5 cycles) × ports (2) in flight.
constexpr std::size_t kChains = 12;

/// Runs `steps` FMAs on each chain; returns the operations done. `sink` keeps them alive.
double run_fmas(std::size_t steps, float* sink) {
  const hn::ScalableTag<float> f32;
  hn::Vec<decltype(f32)> chain[kChains];
  for (std::size_t i = 0; i < kChains; ++i) chain[i] = hn::Set(f32, static_cast<float>(i));
  const auto scale = hn::Set(f32, 0.999f), shift = hn::Set(f32, 1e-3f);
  for (std::size_t step = 0; step < steps; ++step) {
    for (auto& value : chain) value = hn::MulAdd(value, scale, shift);
  }
  auto sum = chain[0];
  for (std::size_t i = 1; i < kChains; ++i) sum = hn::Add(sum, chain[i]);
  *sink += hn::GetLane(hn::SumOfLanes(f32, sum));
  return 2.0 * static_cast<double>(steps * kChains * hn::Lanes(f32));
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rimlight::bench
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight::bench {

HWY_EXPORT(run_fmas);

double peak_flops() {
  using Clock = std::chrono::steady_clock;
  volatile float kept = 0;
  float sink = 0;
  double best = 0;
  for (int i = 0; i < 50; ++i) {
    const auto start = Clock::now();
    const double operations = HWY_DYNAMIC_DISPATCH(run_fmas)(20000, &sink);
    best = std::max(best, operations / std::chrono::duration<double>(Clock::now() - start).count());
  }
  kept = sink;
  static_cast<void>(kept);
  return best;
}

}  // namespace rimlight::bench
#endif  // HWY_ONCE
