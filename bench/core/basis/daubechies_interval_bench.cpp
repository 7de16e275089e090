// The Daubechies transform of a curve (256 samples, RGB as three lanes) and of a tile of pixels'
// curve transport (64 pixels, RGB: 192 lanes), with `of_copy_bandwidth`: the bytes that it must
// read and write once, over what memcpy moves of the same size in the same run.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <limits>
#include <vector>

#include "core/basis/daubechies_interval.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t kSize = 256;

/// The best of some copies: bytes read and written a second.
double copy_bandwidth(const std::vector<float>& from, std::vector<float>& to) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 20; ++i) {
    const auto start = Clock::now();
    std::memcpy(to.data(), from.data(), from.size() * sizeof(float));
    benchmark::DoNotOptimize(to.data());
    benchmark::ClobberMemory();
    best = std::min(best, std::chrono::duration<double>(Clock::now() - start).count());
  }
  return 2.0 * static_cast<double>(from.size() * sizeof(float)) / best;
}

template <typename Transform>
void run(benchmark::State& state, const Transform& transform) {
  const DaubechiesInterval basis(kSize);
  const auto lanes = static_cast<std::size_t>(state.range(0));
  Random random(1);
  std::vector<float> samples(kSize * lanes), coefficients(kSize * lanes);
  for (float& value : samples) value = random.uniform_float();
  double seconds = 0;
  for (auto _ : state) {
    const auto start = Clock::now();
    transform(basis, samples, coefficients, lanes);
    benchmark::DoNotOptimize(coefficients.data());
    seconds += std::chrono::duration<double>(Clock::now() - start).count();
  }
  const double bytes = 2.0 * static_cast<double>(samples.size() * sizeof(float)) *
                       static_cast<double>(state.iterations());
  state.counters["of_copy_bandwidth"] = bytes / seconds / copy_bandwidth(samples, coefficients);
}

void forward_interval(benchmark::State& state) {
  run(state, [](const auto& basis, auto& samples, auto& coefficients, std::size_t lanes) {
    basis.forward(samples, coefficients, lanes);
  });
}
BENCHMARK(forward_interval)->Arg(3)->Arg(192)->UseRealTime();

void inverse_interval(benchmark::State& state) {
  run(state, [](const auto& basis, auto& samples, auto& coefficients, std::size_t lanes) {
    basis.inverse(std::span<const float>(samples), coefficients, lanes);
  });
}
BENCHMARK(inverse_interval)->Arg(3)->Arg(192)->UseRealTime();

}  // namespace
}  // namespace rimlight
