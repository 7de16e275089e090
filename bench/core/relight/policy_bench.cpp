// Planning one update under a light that turns, each policy at N = 32 and 64 with budgets of 30 and
// 3,000 coefficients, and benefit with a budget in bytes. `of_read` is how often target and held
// could be read in the same time.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/math/random.h"
#include "core/relight/policy_settings.h"

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

/// Columns as bakes have them: a finer band's are sparser and darker.
struct Columns {
  std::vector<float> norm_squared;
  std::vector<std::uint32_t> bytes;

  explicit Columns(const CubeHaar& haar)
      : norm_squared(3 * haar.coefficient_count()), bytes(haar.coefficient_count()) {
    Random random(3);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const double share = std::exp2(-2 * haar.band_of(i)) * random.uniform(0.1, 1);
      bytes[i] = static_cast<std::uint32_t>(1.6e6 * share);
      for (std::size_t c = 0; c < 3; ++c) {
        norm_squared[c * bytes.size() + i] = static_cast<float>(share * random.uniform());
      }
    }
  }
};

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

void plan(benchmark::State& state, const std::string& name, Budget::Unit unit) {
  const CubeHaar haar(static_cast<int>(state.range(0)));
  const CubeLight target = random_light(haar, 1);
  CubeLight held = random_light(haar, 2);
  // Coarse bands are near the target, fine ones are not: some are incremented, some reset.
  for (std::size_t i = 0; i < haar.band_begin(3); ++i) {
    for (int c = 0; c < 3; ++c) held.channel(c)[i] = 0.9f * target.channel(c)[i];
  }
  const Columns columns(haar);
  const auto policy = make_policy(parse_policy(name, "bench"));
  constexpr std::size_t kImageBytes = 12 * 512 * 512;
  const PlanRequest request{haar,
                            target,
                            held,
                            {unit, static_cast<std::size_t>(state.range(1))},
                            columns.norm_squared,
                            columns.bytes,
                            kImageBytes};
  PlanWorkspace workspace;
  UpdatePlan update;
  const auto start = Clock::now();
  for (auto _ : state) {
    policy->make_plan(request, workspace, update);
    benchmark::DoNotOptimize(update.columns.data());
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
  state.counters["of_read"] =
      seconds / static_cast<double>(state.iterations()) / read_seconds(target, held);
  state.counters["columns"] = static_cast<double>(update.columns.size());
}

constexpr auto kCoefficients = Budget::Unit::coefficients;

void register_benchmarks() {
  for (const char* const name :
       {"linear", "nwa", "bi", "pbi", "pbi:transport", "pbi:dealer", "pbi:exhaustive", "benefit"}) {
    benchmark::RegisterBenchmark(name,
                                 [=](benchmark::State& state) { plan(state, name, kCoefficients); })
        ->ArgsProduct({{32, 64}, {30, 3000}})
        ->Unit(benchmark::kMicrosecond)
        ->UseRealTime();
  }
  benchmark::RegisterBenchmark(
      "benefit/bytes", [](benchmark::State& state) { plan(state, "benefit", Budget::Unit::bytes); })
      ->ArgsProduct({{32, 64}, {4 << 20, 16 << 20}})
      ->Unit(benchmark::kMicrosecond)
      ->UseRealTime();
}

}  // namespace
}  // namespace rimlight

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  rimlight::register_benchmarks();
  benchmark::RunSpecifiedBenchmarks();
}
