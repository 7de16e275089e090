// Spherical harmonics on one thread. Beside the time, from the best of all iterations:
//
//   ns_value  a value of the basis at one direction (evaluate), in blocks of 64 directions
//   us        one rotation of a light: built from the quaternion and applied to three signals
//   of_peak   the operations that the algorithm needs (an FMA is two, one in double counts twice)
//             over the peak FLOP/s in single precision, measured in this run
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <vector>

#include "bench/support/peak_flops.h"
#include "core/basis/sh.h"
#include "core/basis/sh_kernel.h"
#include "core/math/random.h"
#include "core/math/sampling.h"

namespace rimlight {
namespace {

using Clock = std::chrono::steady_clock;

/// The fastest of the iterations, in seconds.
template <typename Action>
double best_time(benchmark::State& state, const Action& action) {
  double best = std::numeric_limits<double>::infinity();
  for (auto _ : state) {
    const auto start = Clock::now();
    action();
    benchmark::ClobberMemory();
    best = std::min(best, std::chrono::duration<double>(Clock::now() - start).count());
  }
  return best;
}

void evaluate(benchmark::State& state) {
  const auto degree = static_cast<int>(state.range(0));
  constexpr std::size_t kCount = 64, kBlocks = 64;
  Random random(1);
  std::vector<Vec3d> some(kCount * kBlocks);
  for (Vec3d& d : some) d = uniform_sphere(random_sample(random));
  const sh::Directions directions(some);
  AlignedVector<float> values(sh::coefficient_count(degree) * kCount);
  const double seconds = best_time(state, [&] {
    for (std::size_t block = 0; block < kBlocks; ++block) {
      sh::evaluate(directions.part(block * kCount, kCount), degree, values, kCount);
      benchmark::DoNotOptimize(values.data());
    }
  });
  const auto count = static_cast<double>(values.size() * kBlocks);
  // For a pair of values: two products and an FMA in double, and two products in single.
  state.counters["of_peak"] = 5 * count / seconds / bench::peak_flops();
  state.counters["ns_value"] = 1e9 * seconds / count;
  state.SetLabel(sh::kernel_target());
}

BENCHMARK(evaluate)->ArgName("degree")->Arg(4)->Arg(10)->Arg(20)->Arg(32)->UseRealTime();

}  // namespace
}  // namespace rimlight
