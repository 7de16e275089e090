// The full calculation of many vertices, on all threads. Beside the time of a call:
//
//   ns_vertex   median time ÷ vertices selected, of which every second one is
//   of_peak     multiplications and additions of the matrix products a second ÷ peak_flops() of
//   this
//               run · threads
#include "core/vertices/vertex_products.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <vector>

#include "bench/support/peak_flops.h"
#include "core/base/parallel.h"
#include "core/base/stopwatch.h"
#include "tests/core/vertices/random_vertices.h"

namespace rimlight {
namespace {

constexpr std::size_t kVertices = 50'000;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

enum class Task { irradiance, highlights, incident_by_vertex };

void calculate(benchmark::State& state, Task task) {
  const auto degree = static_cast<int>(state.range(0));
  const test::RandomVertices vertices({kVertices, kVertices, degree, degree});
  VertexProducts products(vertices.view());
  products.set_light(test::RandomVertices::light(2 * degree));
  std::vector<std::uint32_t> chosen;
  for (std::uint32_t v = 0; v < kVertices; v += 2) chosen.push_back(v);
  VertexSelection selection;
  selection.select_vertices(chosen);
  std::vector<float> to(task == Task::incident_by_vertex
                            ? kVertices * kLightChannels * products.row_stride()
                            : selection.panel_count() * kLightChannels * kBatchVertices);
  std::vector<double> seconds;
  for (auto _ : state) {
    const Stopwatch watch;
    if (task == Task::irradiance) products.irradiance(selection, to);
    if (task == Task::highlights) products.highlights(selection, vertices.gloss(), to);
    if (task == Task::incident_by_vertex) products.incident_by_vertex(selection, to);
    benchmark::DoNotOptimize(to.data());
    seconds.push_back(watch.elapsed_seconds());
    state.SetIterationTime(seconds.back());
  }
  const double of_one = median(seconds) / static_cast<double>(chosen.size());
  state.SetLabel(vertex_product_target());
  state.counters["ns_vertex"] = 1e9 * of_one;
  if (task == Task::irradiance) return;
  state.counters["of_peak"] =
      products.highlight_flops() / of_one / (bench::peak_flops() * thread_count());
}

BENCHMARK_CAPTURE(calculate, irradiance, Task::irradiance)->Arg(10)->Arg(13)->UseManualTime();
BENCHMARK_CAPTURE(calculate, highlights, Task::highlights)->Arg(10)->Arg(13)->UseManualTime();
BENCHMARK_CAPTURE(calculate, incident_by_vertex, Task::incident_by_vertex)
    ->Arg(10)
    ->Arg(13)
    ->UseManualTime();

}  // namespace
}  // namespace rimlight
