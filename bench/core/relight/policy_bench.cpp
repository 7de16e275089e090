// Planning one update of 30 coefficients under a light that turns, at N = 32 and 64. `of_read` is
// how often target and held could be read in the same time.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>
#include <limits>

#include "core/math/random.h"
#include "core/relight/policy.h"

namespace rimlight {
namespace {

using Clock = std::chrono::steady_clock;

/// Coefficients as environments have them: smaller by half in each finer band, with few large ones.
CubeLight random_light(const CubeHaar& haar, std::uint64_t seed) {
  Random random(seed);
  CubeLight light(haar.size());
  for (std::size_t i = 0; i < light.count(); ++i) {
    const double size = std::exp2(-haar.band_of(i)) * std::pow(random.uniform(), 8);
    for (int c = 0; c < 3; ++c)
      light.channel(c)[i] = static_cast<float>(random.uniform(-size, size));
  }
  return light;
}

double read_seconds(const CubeLight& target, const CubeLight& held) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 20; ++i) {
    const auto start = Clock::now();
    float sums[16] = {};
    for (std::size_t k = 0; k + 16 <= target.values.size(); k += 16) {
      for (std::size_t j = 0; j < 16; ++j) sums[j] += target.values[k + j] + held.values[k + j];
    }
    benchmark::DoNotOptimize(sums);
    best = std::min(best, std::chrono::duration<double>(Clock::now() - start).count());
  }
  return best;
}

template <typename Policy>
void plan(benchmark::State& state) {
  const CubeHaar haar(static_cast<int>(state.range(0)));
  const CubeLight target = random_light(haar, 1);
  CubeLight held = random_light(haar, 2);
  // Coarse bands are near the target, fine ones are not: some are incremented, some reset.
  for (std::size_t i = 0; i < haar.band_begin(3); ++i) {
    for (int c = 0; c < 3; ++c) held.channel(c)[i] = 0.9f * target.channel(c)[i];
  }
  const Policy policy;
  PlanWorkspace workspace;
  UpdatePlan update;
  const auto start = Clock::now();
  for (auto _ : state) {
    policy.make_plan({haar, target, held, 30}, workspace, update);
    benchmark::DoNotOptimize(update.columns.data());
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  state.counters["of_read"] =
      seconds / static_cast<double>(state.iterations()) / read_seconds(target, held);
}

BENCHMARK_TEMPLATE(plan, NwaPolicy)->Arg(32)->Arg(64)->Unit(benchmark::kMicrosecond)->UseRealTime();
BENCHMARK_TEMPLATE(plan, PbiPolicy)->Arg(32)->Arg(64)->Unit(benchmark::kMicrosecond)->UseRealTime();

}  // namespace
}  // namespace rimlight
