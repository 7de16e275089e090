// Products of spherical harmonics to one degree, on one thread. Beside the time of a call:
//
//   ns_product   median time ÷ receivers of a call
//   of_peak      additions and multiplications done a second ÷ peak_flops() of this run
//   of_tripling  median time of the sum over tripling coefficients, in scalar code, ÷ ns_product;
//                in turn in this run
#include <benchmark/benchmark.h>

#include <algorithm>
#include <vector>

#include "bench/core/basis/peak_flops.h"
#include "core/base/stopwatch.h"
#include "core/basis/sh_product.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

constexpr std::size_t kReceivers = 64;

AlignedVector<float> random_values(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  AlignedVector<float> values(count);
  for (float& value : values) value = static_cast<float>(random.uniform(-1, 1));
  return values;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Non-zero C(i, j, k) with all three to one degree, as a plain list.
struct Term {
  std::uint16_t i, j, k;
  float value;
};
std::vector<Term> terms_to(int degree) {
  std::vector<Term> terms;
  const std::size_t end = sh_product::coefficient_count(degree);
  ShTripling::to_degree(degree).for_each(
      [&](std::size_t i, std::size_t j, std::size_t k, float value) {
        if (k >= end) return;
        terms.push_back({static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j),
                         static_cast<std::uint16_t>(k), i == j ? value / 2 : value});
      });
  return terms;
}

double seconds_of_tripling(const std::vector<Term>& terms, const float* f, const float* g,
                           std::vector<float>& product) {
  const Stopwatch watch;
  std::ranges::fill(product, 0.0f);
  for (const Term& t : terms) product[t.k] += t.value * (f[t.i] * g[t.j] + f[t.j] * g[t.i]);
  benchmark::DoNotOptimize(product.data());
  return watch.elapsed_seconds();
}

void project_product(benchmark::State& state) {
  const auto degree = static_cast<int>(state.range(0));
  const std::size_t count = sh_product::coefficient_count(degree);
  const auto f = random_values(count * kReceivers, 1), g = random_values(count * kReceivers, 2);
  AlignedVector<float> product(f.size());
  const std::vector<Term> terms = terms_to(degree);
  std::vector<float> one(count);
  const ShProduct plan({degree, degree, degree});
  ShProduct::Workspace workspace;
  std::vector<double> seconds, tripling_seconds;
  for (auto _ : state) {
    const Stopwatch watch;
    plan.multiply(f, g, product, kReceivers, workspace);
    benchmark::DoNotOptimize(product.data());
    seconds.push_back(watch.elapsed_seconds());
    state.SetIterationTime(seconds.back());
    tripling_seconds.push_back(seconds_of_tripling(terms, f.data(), g.data(), one));
  }
  const double of_one = median(seconds) / static_cast<double>(kReceivers);
  state.SetLabel(sh_product_target());
  state.counters["ns_product"] = 1e9 * of_one;
  state.counters["of_peak"] = plan.flops() / of_one / peak_flops();
  state.counters["of_tripling"] = median(tripling_seconds) / of_one;
}

BENCHMARK(project_product)->ArgName("degree")->Arg(9)->Arg(10)->Arg(12)->Arg(13)->UseManualTime();

}  // namespace
}  // namespace rimlight
