// Rotating "sunny" and "cathedral" on one core, alone and with the Haar transform of the three
// channels: what a frame costs when the light turns. `of_copy` is how many plain copies of the
// light take the same time, measured in the same run.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cstring>
#include <limits>
#include <string>

#include "core/basis/cube_haar.h"
#include "core/light/environment.h"
#include "core/light/light_rotation.h"

namespace rimlight {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double copy_seconds(const CubeLight& from, CubeLight& to) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 20; ++i) {
    const auto start = Clock::now();
    std::memcpy(to.values.data(), from.values.data(), from.values.size() * sizeof(float));
    benchmark::DoNotOptimize(to.values.data());
    benchmark::ClobberMemory();
    best = std::min(best, seconds_since(start));
  }
  return best;
}

template <typename Frame>
void turn(benchmark::State& state, const std::string& name, const Frame& frame) {
  const int size = static_cast<int>(state.range(0));
  LightRotator rotator(builtin_environment(name).project(size));
  const CubeHaar haar(size);
  CubeLight target(size), coefficients(size);
  Random random(1);
  double seconds = 0;
  for (auto _ : state) {
    const Quaternion rotation = random_rotation(random);
    const auto start = Clock::now();
    rotator.rotate(rotation, target);
    frame(haar, target, coefficients);
    benchmark::DoNotOptimize(coefficients.values.data());
    seconds += seconds_since(start);
  }
  state.counters["of_copy"] =
      seconds / static_cast<double>(state.iterations()) / copy_seconds(rotator.source(), target);
}

void rotate(benchmark::State& state, const std::string& name) {
  turn(state, name, [](const CubeHaar&, CubeLight&, CubeLight&) {});
}

void rotate_and_transform(benchmark::State& state, const std::string& name) {
  turn(state, name, [](const CubeHaar& haar, CubeLight& texels, CubeLight& coefficients) {
    for (int c = 0; c < 3; ++c) haar.forward(texels.channel(c), coefficients.channel(c));
  });
}

BENCHMARK_CAPTURE(rotate, sunny, "sunny")->Arg(32)->Arg(64)->Arg(128)->UseRealTime();
BENCHMARK_CAPTURE(rotate, cathedral, "cathedral")->Arg(32)->Arg(64)->Arg(128)->UseRealTime();
BENCHMARK_CAPTURE(rotate_and_transform, sunny, "sunny")->Arg(32)->Arg(64)->Arg(128)->UseRealTime();
BENCHMARK_CAPTURE(rotate_and_transform, cathedral, "cathedral")
    ->Arg(32)
    ->Arg(64)
    ->Arg(128)
    ->UseRealTime();

}  // namespace
}  // namespace rimlight
