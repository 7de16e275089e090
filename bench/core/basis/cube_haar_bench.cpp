// The Haar transform of a light (three signals, one lane each) and of a tile of transport rows (192
// lanes), each with `of_copy_bandwidth`: the bytes that it must read and write once, over what
// memcpy moves of the same size in the same run.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cstring>
#include <limits>
#include <vector>

#include "core/basis/cube_haar.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

using Clock = std::chrono::steady_clock;

std::vector<float> random_values(std::size_t count) {
  Random random(1);
  std::vector<float> values(count);
  for (float& value : values) value = random.uniform_float();
  return values;
}

/// The best of some copies: bytes read and written a second.
double copy_bandwidth(std::vector<float>& from, std::vector<float>& to) {
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

/// Arguments: size, lanes, signals (transforms of `lanes` lanes one after another).
template <typename Transform>
void run(benchmark::State& state, const Transform& transform) {
  const CubeHaar haar(static_cast<int>(state.range(0)));
  const auto lanes = static_cast<std::size_t>(state.range(1));
  const auto signals = static_cast<std::size_t>(state.range(2));
  auto texels = random_values(haar.coefficient_count() * lanes);
  auto coefficients = texels;
  double seconds = 0;
  for (auto _ : state) {
    const auto start = Clock::now();
    for (std::size_t i = 0; i < signals; ++i) transform(haar, texels, coefficients, lanes);
    benchmark::DoNotOptimize(coefficients.data());
    seconds += std::chrono::duration<double>(Clock::now() - start).count();
  }
  const double bytes = 2.0 * static_cast<double>(texels.size() * signals * sizeof(float)) *
                       static_cast<double>(state.iterations());
  state.counters["of_copy_bandwidth"] = bytes / seconds / copy_bandwidth(texels, coefficients);
}

void forward(benchmark::State& state) {
  run(state, [](const CubeHaar& haar, auto& texels, auto& coefficients, std::size_t lanes) {
    haar.forward(texels, coefficients, lanes);
  });
}
void inverse(benchmark::State& state) {
  run(state, [](const CubeHaar& haar, auto& texels, auto& coefficients, std::size_t lanes) {
    haar.inverse(coefficients, texels, lanes);
  });
}

BENCHMARK(forward)->Args({32, 1, 3})->Args({64, 1, 3})->Args({128, 1, 3})->UseRealTime();
BENCHMARK(forward)->Args({32, 192, 1})->Args({64, 192, 1})->UseRealTime();
BENCHMARK(inverse)->Args({32, 1, 3})->Args({64, 1, 3})->Args({128, 1, 3})->UseRealTime();
BENCHMARK(inverse)->Args({32, 192, 1})->Args({64, 192, 1})->UseRealTime();

}  // namespace
}  // namespace rimlight
