// Surfaces of a bumpy ball, from which a third of the sky is hidden, in a light of 32 × 32
// texels a face with a sun in it: Cook–Torrance, and a measured BRDF. Beside the time:
//
//   ns_point       rebuild: median time · threads ÷ (surfaces · texels · 4 quarters)
//   of_read_limit  columns: median time ÷ (bytes of T̂ ÷ read bandwidth), the bandwidth measured in
//                  this run on as many threads
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>

#include "core/base/parallel.h"
#include "core/curves/curve_updater.h"
#include "core/curves/quick_image.h"
#include "core/math/random.h"
#include "core/transport/receivers.h"

namespace rimlight {
namespace {

constexpr int kSize = 32;
constexpr std::size_t kStrongest = 64;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

FactoredBrdf measured() {
  FactoredBrdf brdf;
  for (std::size_t i = 0; i < kCurveBins; ++i) {
    const auto x = static_cast<float>(i) / kCurveBins;
    brdf.half_angle.values[i] = {0.1f + 20 * std::exp(-30 * x), 0.2f + 9 * std::exp(-20 * x), 1};
    brdf.difference_angle.values[i] = {1 + x, 1 + 2 * x * x, 0.7f + 0.1f * x};
  }
  for (std::size_t i = 0; i < kRestKnots; ++i) {
    brdf.rest[i] = Vec3f::filled(1 + 0.01f * static_cast<float>(i));
  }
  return brdf;
}

/// Seen but for what lies below, with a soft border.
std::vector<std::uint8_t> seen_sky() {
  std::vector<std::uint8_t> fifths(cube::texel_count(kSize));
  for (std::size_t i = 0; i < fifths.size(); ++i) {
    const double height = cube::texel_direction(i, kSize).y + 0.3;
    fifths[i] = static_cast<std::uint8_t>(std::clamp(std::floor(20 * height), 0.0, 5.0));
  }
  return fifths;
}

struct Ball {
  std::vector<CurveMaterial> materials;
  std::vector<CurveSurface> surfaces;
  std::vector<std::uint8_t> fifths = seen_sky();
  SkyVisibilityPacker visibility{kSize};
  CubeLight light{kSize};
  CurveSky sky{kSize};
  std::unique_ptr<CurveLight> curve_light;
  std::unique_ptr<CurveTransport> transport;
  std::vector<CurveMaterialState> states;

  Ball(bool is_measured, std::size_t rows) {
    CurveMaterial material{
        "ball",
        {.model = BrdfModel::cook_torrance, .albedo = {0.5f, 0.3f, 0.1f}, .specular = {1, 1, 1}}};
    if (is_measured) material.measured = measured();
    materials.push_back(material);
    for (std::size_t row = 0; row < rows; ++row) add_row(row, rows);
    for (std::size_t i = 0; i < light.count(); ++i) {
      const Vec3d at = cube::texel_direction(i, kSize);
      for (int c = 0; c < 3; ++c) {
        light.channel(c)[i] = static_cast<float>(1 + 0.5 * at.y) + (i % 997 == 3 ? 100.0f : 0.0f);
      }
    }
    curve_light = std::make_unique<CurveLight>(sky, light, kStrongest);
    transport = std::make_unique<CurveTransport>(
        CurveReceivers{materials, {}, surfaces, visibility.view()});
    states.push_back(resolve(materials[0], {}, {}, "ball"));
  }

  void add_row(std::size_t row, std::size_t rows) {
    Random random(5, row);
    const double y = 1 - 2 * (static_cast<double>(row) + 0.5) / static_cast<double>(rows);
    const double turn = 2.4 * static_cast<double>(row), flat = std::sqrt(1 - y * y);
    Vec3d normal{flat * std::cos(turn), y, std::abs(flat * std::sin(turn))};
    normal = normalized(normal + Vec3d{random.uniform(), random.uniform(), random.uniform()} * 0.1);
    CurveSurface surface;
    surface.receiver = static_cast<std::uint32_t>(row);
    surface.share = 1;
    surface.tint = {1, 1, 1};
    Vec3f outgoing{0, 0, 1};
    if (normal.z < 0.02) outgoing = normalized(Vec3f(normal) + outgoing);
    surface.points.fill({Vec3f(normal), {1, 0, 0}, Vec3f(normal), outgoing});
    surfaces.push_back(surface);
    visibility.add(fifths);
  }
};

Ball& ball(bool is_measured, std::size_t rows) {
  static std::unique_ptr<Ball> made;
  static bool was_measured = false;
  static std::size_t had = 0;
  if (!made || was_measured != is_measured || had != rows) {
    made.reset();
    made = std::make_unique<Ball>(is_measured, rows);
    was_measured = is_measured;
    had = rows;
  }
  return *made;
}

void rebuild_all(Ball& ball, CurveAxis axis) {
  parallel_for(ball.transport->panels().size(), [&](std::size_t panel) {
    ball.transport->rebuild(panel, *ball.curve_light, ball.states[0], axis, 1);
  });
}

void rebuild(benchmark::State& state) {
  Ball& test = ball(state.range(1) != 0, static_cast<std::size_t>(state.range(0)));
  const CurveAxis axis = state.range(2) == 0 ? CurveAxis::half_angle : CurveAxis::difference_angle;
  double best = std::numeric_limits<double>::infinity();
  for (auto _ : state) {
    const auto start = Clock::now();
    rebuild_all(test, axis);
    best = std::min(best, seconds_since(start));
  }
  const auto points = static_cast<double>(test.surfaces.size() * cube::texel_count(kSize) * 4);
  state.counters["ns_point"] = 1e9 * best * thread_count() / points;
}

void quick(benchmark::State& state) {
  Ball& test = ball(state.range(1) != 0, static_cast<std::size_t>(state.range(0)));
  AlignedVector<float> image(test.transport->panels().size() * kPanelFloats);
  QuickShader shader(*test.transport, test.states);
  const auto panels = test.transport->all_panels();
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        shader.shade(*test.curve_light, panels, QuickDetail::every_row, {}, image));
  }
  double size = 0;
  for (const float value : image) size += double{value} * value;
  const double error = shader.sampled_squared_error(*test.curve_light, panels, image, 1000, 1);
  state.counters["relative_error"] = std::sqrt(error / size);
}

void norms(benchmark::State& state) {
  Ball& test = ball(false, static_cast<std::size_t>(state.range(0)));
  rebuild_all(test, CurveAxis::half_angle);
  for (auto _ : state) test.transport->find_norms(0, CurveAxis::half_angle);
}

/// Bytes a second, reading half a GiB on the threads in use; the best of five.
double read_bandwidth() {
  static const AlignedVector<std::uint64_t> memory(std::size_t{1} << 26, 1);
  constexpr std::size_t kChunks = 64;
  std::vector<std::uint64_t> sums(kChunks);
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 5; ++i) {
    const auto start = Clock::now();
    parallel_for(kChunks, [&](std::size_t chunk) {
      const std::size_t size = memory.size() / kChunks;
      const std::uint64_t* const first = memory.data() + chunk * size;
      std::uint64_t lanes[8] = {};
      for (std::size_t k = 0; k < size; k += 8) {
        for (std::size_t lane = 0; lane < 8; ++lane) lanes[lane] += first[k + lane];
      }
      for (const std::uint64_t lane : lanes) sums[chunk] += lane;
    });
    benchmark::DoNotOptimize(sums.data());
    best = std::min(best, seconds_since(start));
  }
  return static_cast<double>(memory.size() * sizeof(std::uint64_t)) / best;
}

void columns(benchmark::State& state) {
  Ball& test = ball(false, static_cast<std::size_t>(state.range(0)));
  rebuild_all(test, CurveAxis::half_angle);
  const auto count = static_cast<std::size_t>(state.range(1));
  CurveUpdater updater(*test.transport, CurvePolicy::bi);
  updater.show(0, CurveAxis::half_angle, {});
  CurveCoefficients targets[2];
  for (std::size_t k = 0; k < kCurveBins; ++k) targets[0][k] = {1, 1, 1};
  std::vector<double> times;
  std::size_t bytes = 0, turn = 0;
  for (auto _ : state) {
    updater.set_target(0, targets[turn++ / (kCurveBins / count) % 2]);
    const auto start = Clock::now();
    bytes = updater.update({FrameBudget::Unit::coefficients, static_cast<double>(count)}).bytes;
    times.push_back(seconds_since(start));
  }
  std::ranges::nth_element(times, times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2));
  state.counters["of_read_limit"] =
      times[times.size() / 2] / (static_cast<double>(bytes) / read_bandwidth());
}

BENCHMARK(rebuild)
    ->ArgNames({"rows", "measured", "axis"})
    ->Args({100'000, 0, 0})
    ->Args({100'000, 0, 1})
    ->Args({100'000, 1, 0})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(quick)
    ->ArgNames({"rows", "measured"})
    ->Args({100'000, 0})
    ->Args({100'000, 1})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(norms)->Arg(100'000)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(columns)
    ->ArgNames({"rows", "columns"})
    ->Args({100'000, 16})
    ->Args({100'000, 64})
    ->Args({100'000, 256})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace rimlight

BENCHMARK_MAIN();
