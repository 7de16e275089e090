// Spherical harmonics on one thread. Beside the time, from the best of all iterations:
//
//   ns_value  a value of the basis at one direction (evaluate), in blocks of so many directions
//   us        one rotation of a light of one or three signals, built from the quaternion and
//             applied; or one projection of a cube map of 64 texels a side in three channels
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
#include "core/basis/sh_projection.h"
#include "core/basis/sh_rotation.h"
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
  const auto block_size = static_cast<std::size_t>(state.range(1));
  const std::size_t blocks = 4096 / block_size;
  Random random(1);
  std::vector<Vec3d> some(block_size * blocks);
  for (Vec3d& d : some) d = uniform_sphere(random_sample(random));
  const sh::Directions directions(some);
  AlignedVector<float> values(sh::coefficient_count(degree) * block_size);
  const double seconds = best_time(state, [&] {
    for (std::size_t block = 0; block < blocks; ++block) {
      sh::evaluate(directions.part(block * block_size, block_size), degree, values, block_size);
      benchmark::DoNotOptimize(values.data());
    }
  });
  const auto count = static_cast<double>(values.size() * blocks);
  // For a pair of values: two products and an FMA in double, and two products in single.
  state.counters["of_peak"] = 5 * count / seconds / bench::peak_flops();
  state.counters["ns_value"] = 1e9 * seconds / count;
  state.SetLabel(sh::kernel_target());
}

void rotate(benchmark::State& state) {
  const auto degree = static_cast<int>(state.range(0));
  const auto signals = static_cast<std::size_t>(state.range(1));
  Random random(2);
  AlignedVector<float> light(signals * sh::coefficient_count(degree)), rotated(light.size());
  for (float& value : light) value = random.uniform_float();
  constexpr int kRotations = 64;
  std::vector<Quaternion> rotations(kRotations);
  for (Quaternion& rotation : rotations) rotation = random_rotation(random);
  const double seconds = best_time(state,
                                   [&] {
                                     for (const Quaternion& rotation : rotations) {
                                       sh::Rotation(rotation, degree).apply(light, rotated);
                                       benchmark::DoNotOptimize(rotated.data());
                                     }
                                   }) /
                         kRotations;
  double operations = 0;  // of one signal, in double
  for (int l = 0; l <= degree; ++l) {
    const int m_pairs = 2 * l + 1, exchanged = (l + 1) * (l + 1) + l * l;
    operations += 3.0 * 3 * m_pairs + 2.0 * exchanged;
  }
  state.counters["of_peak"] =
      2 * operations * static_cast<double>(signals) / seconds / bench::peak_flops();
  state.counters["us"] = 1e6 * seconds;
}

/// A cube map of 64 texels a side, three channels.
void project(benchmark::State& state) {
  const auto degree = static_cast<int>(state.range(0));
  const sh::SphereQuadrature texels = sh::cube_quadrature(64);
  Random random(3);
  std::vector<float> light(3 * texels.directions.count());
  for (float& value : light) value = random.uniform_float();
  const double seconds = best_time(
      state, [&] { benchmark::DoNotOptimize(sh::project(texels, light, degree).data()); });
  // The basis as above, and an FMA for each channel.
  const double values = static_cast<double>(texels.directions.count()) *
                        static_cast<double>(sh::coefficient_count(degree));
  state.counters["of_peak"] = (5 + 6) * values / seconds / bench::peak_flops();
  state.counters["us"] = 1e6 * seconds;
}

BENCHMARK(evaluate)
    ->ArgNames({"degree", "block"})
    ->ArgsProduct({{4, 10, 20, 32}, {16, 64}})
    ->UseRealTime();
BENCHMARK(rotate)
    ->ArgNames({"degree", "signals"})
    ->ArgsProduct({{4, 10, 20, 32}, {1, 3}})
    ->UseRealTime();

BENCHMARK(project)->ArgName("degree")->Arg(10)->Arg(20)->UseRealTime();

}  // namespace
}  // namespace rimlight
