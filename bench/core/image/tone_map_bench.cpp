// Tone mapping against what its bytes cost: a copy of the same floats and a store of the same
// bytes.

#include <benchmark/benchmark.h>

#include <chrono>
#include <cstring>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/image/tone_map.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

struct Frame {
  AlignedVector<float> planes[3];
  AlignedVector<std::uint8_t> rgb;

  explicit Frame(std::size_t pixels) : rgb(3 * pixels) {
    Random random(1);
    for (auto& plane : planes) {
      plane.resize(pixels);
      for (float& value : plane) value = 1.2f * random.uniform_float();
    }
  }
};

/// Seconds for one memory copy of as many bytes as tone_map reads and writes, best of a few.
double copy_seconds(const Frame& frame) {
  const std::size_t bytes = (3 * sizeof(float) + 3) * frame.planes[0].size() / 2;
  const std::vector<std::uint8_t> from(bytes, 1);
  std::vector<std::uint8_t> to(bytes);
  double best = 1e9;
  for (int repetition = 0; repetition < 20; ++repetition) {
    const auto start = std::chrono::steady_clock::now();
    std::memcpy(to.data(), from.data(), bytes);
    benchmark::DoNotOptimize(to.data());
    benchmark::ClobberMemory();
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    best = std::min(best, time.count());
  }
  return best;
}

void ToneMap(benchmark::State& state) {
  const auto pixels = static_cast<std::size_t>(state.range(0) * state.range(1));
  Frame frame(pixels);
  const double copy = copy_seconds(frame);
  const auto start = std::chrono::steady_clock::now();
  for (auto _ : state) {
    tone_map(frame.planes[0], frame.planes[1], frame.planes[2], 1.1f, frame.rgb);
    benchmark::DoNotOptimize(frame.rgb.data());
    benchmark::ClobberMemory();
  }
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  const double each = time.count() / static_cast<double>(state.iterations());
  state.counters["ns_per_pixel"] = 1e9 * each / static_cast<double>(pixels);
  state.counters["times_memory_copy"] = each / copy;
}
BENCHMARK(ToneMap)
    ->Args({512, 512})
    ->Args({1920, 1080})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace rimlight

BENCHMARK_MAIN();
