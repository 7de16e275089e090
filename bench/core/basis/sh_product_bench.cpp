// Products of spherical harmonics to one degree, on one thread. Beside the time of a call:
//
//   ns_product   median time ÷ receivers of a call
//   us_build     median time of a product matrix, three channels, the light to twice the degree
//   of_peak      additions and multiplications done a second ÷ peak_flops() of this run
//   of_table     the same multiply-adds by walking the list of tripling coefficients ÷ us_build
//   of_tripling  median time of the sum over tripling coefficients, in scalar code, ÷ ns_product;
//                in turn in this run
#include <benchmark/benchmark.h>

#include <algorithm>
#include <vector>

#include "bench/support/peak_flops.h"
#include "core/base/stopwatch.h"
#include "core/basis/sh_product.h"
#include "core/basis/sh_product_matrix.h"
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
  const std::size_t end = sh::coefficient_count(degree);
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
  const std::size_t count = sh::coefficient_count(degree);
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
  state.counters["of_peak"] = plan.flops() / of_one / bench::peak_flops();
  state.counters["of_tripling"] = median(tripling_seconds) / of_one;
}

/// The matrix by the plain list of coefficients, for all channels: what a build replaces.
double seconds_of_list(const ShTripling& table, const AlignedVector<float>& light,
                       AlignedVector<float>& matrix) {
  const std::size_t size = sh::coefficient_count(table.degree());
  const std::size_t channel = light.size() / ShProductMatrix::kChannels;
  const Stopwatch watch;
  std::ranges::fill(matrix, 0.0f);
  table.for_each([&](std::size_t i, std::size_t j, std::size_t k, float value) {
    for (std::size_t c = 0; c < ShProductMatrix::kChannels; ++c) {
      matrix[(c * size + i) * size + j] += value * light[c * channel + k];
    }
  });
  benchmark::DoNotOptimize(matrix.data());
  return watch.elapsed_seconds();
}

void build_matrix(benchmark::State& state) {
  const auto degree = static_cast<int>(state.range(0));
  const auto light = random_values(3 * sh::coefficient_count(2 * degree), 3);
  ShProductMatrix matrix(degree);
  AlignedVector<float> listed(3 * matrix.size() * matrix.size());
  std::vector<double> seconds, list_seconds;
  for (auto _ : state) {
    const Stopwatch watch;
    matrix.set_light(light);
    benchmark::DoNotOptimize(matrix.row(0, 0));
    seconds.push_back(watch.elapsed_seconds());
    state.SetIterationTime(seconds.back());
    list_seconds.push_back(seconds_of_list(ShTripling::to_degree(degree), light, listed));
  }
  state.SetLabel(sh_product_target());
  state.counters["us_build"] = 1e6 * median(seconds);
  state.counters["of_table"] = median(list_seconds) / median(seconds);
}

/// Arguments: degree, receivers; all degrees at once, or one after another.
void multiply_matrix(benchmark::State& state, bool by_degree) {
  const auto degree = static_cast<int>(state.range(0));
  const auto receivers = static_cast<std::size_t>(state.range(1));
  ShProductMatrix matrix(degree);
  matrix.set_light(random_values(3 * sh::coefficient_count(2 * degree), 4));
  const auto transport = random_values(matrix.size() * receivers, 5);
  AlignedVector<float> product(3 * transport.size());
  std::vector<double> seconds;
  for (auto _ : state) {
    const Stopwatch watch;
    std::ranges::fill(product, 0.0f);
    for (int l = 0; l <= degree; l = by_degree ? l + 1 : degree + 1) {
      add_product_degrees(matrix, {l, by_degree ? l : degree}, transport, product, receivers);
    }
    benchmark::DoNotOptimize(product.data());
    seconds.push_back(watch.elapsed_seconds());
    state.SetIterationTime(seconds.back());
  }
  const double of_one = median(seconds) / static_cast<double>(receivers);
  state.SetLabel(sh_product_target());
  state.counters["ns_product"] = 1e9 * of_one;
  state.counters["of_peak"] = product_degrees_flops({0, degree}) / of_one / bench::peak_flops();
}

BENCHMARK(build_matrix)->ArgName("degree")->Arg(10)->Arg(13)->UseManualTime();
BENCHMARK_CAPTURE(multiply_matrix, at_once, false)
    ->ArgNames({"degree", "receivers"})
    ->ArgsProduct({{9, 10, 13}, {64, 256}})
    ->UseManualTime();
BENCHMARK_CAPTURE(multiply_matrix, by_degree, true)
    ->ArgNames({"degree", "receivers"})
    ->ArgsProduct({{9, 10, 13}, {64}})
    ->UseManualTime();
BENCHMARK(project_product)->ArgName("degree")->Arg(9)->Arg(10)->Arg(12)->Arg(13)->UseManualTime();

}  // namespace
}  // namespace rimlight
