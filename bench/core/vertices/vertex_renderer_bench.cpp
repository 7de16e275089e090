// Frames of 512 × 512 of about 50,000 vertices that all have highlights, degree 10, on all threads:
// two spheres that fill most of the picture. Beside the median time of a frame:
//
//   rotate_ms, update_ms, display_ms   medians of the report's times
//   of_products   light changes: the frame's time ÷ that of calculating the same vertices' light
//                 alone, in this run; 1 would be a frame for nothing
//   p95_of_deadline, worst_of_deadline   under a deadline: the 95th percentile of whole frames and
//                 the longest of them ÷ the deadline
//   estimate      under a deadline: the median of what the report says that time will mend
//   of_rays       view changes: the frame's time ÷ that of tracing the same rays alone
#include <benchmark/benchmark.h>

#include <algorithm>
#include <numbers>

#include "core/base/stopwatch.h"
#include "core/vertices/vertex_lighting.h"
#include "core/vertices/vertex_renderer.h"
#include "core/vertices/vertex_view.h"
#include "tests/core/vertices/vertex_case.h"

namespace rimlight {
namespace {

constexpr int kSide = 512, kDegree = 10;

std::shared_ptr<const VertexScene> bench_scene(std::size_t channels) {
  test::VertexCase made({.rings = 111,
                         .irradiance_degree = kDegree,
                         .visibility_degree = kDegree,
                         .channels = channels,
                         .width = kSide,
                         .height = kSide});
  made.scene.camera.position = {0, 0.6, 2.4};
  made.scene.camera.target = {0, 0, 0};
  made.scene.camera.vertical_field_of_view_degrees = 45;
  return std::make_shared<const VertexScene>(std::move(made.scene));
}

const std::shared_ptr<const VertexScene>& scene_of_channels(std::size_t channels) {
  static const auto one = bench_scene(1), three = bench_scene(3);
  return channels == 1 ? one : three;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

template <typename Work>
double median_ms(const Work& work) {
  std::vector<double> times;
  for (int i = 0; i < 15; ++i) {
    const Stopwatch watch;
    work(i);
    times.push_back(watch.elapsed_ms());
  }
  return median(times);
}

/// The times of a run's frames.
struct Frames {
  std::vector<double> rotate, update, display, whole;

  void add(benchmark::State& state, const FrameReport& report, double ms) {
    rotate.push_back(report.rotate_ms);
    update.push_back(report.update_ms);
    display.push_back(report.display_ms);
    whole.push_back(ms);
    state.SetIterationTime(ms * 1e-3);
  }
  void say(benchmark::State& state) const {
    state.counters["rotate_ms"] = median(rotate);
    state.counters["update_ms"] = median(update);
    state.counters["display_ms"] = median(display);
    state.counters["median_ms"] = median(whole);
  }
};

DesignState turned_state(int step) {
  DesignState state;
  state.environment = "sky";
  state.rotation = axis_angle({0.2, 1, 0.1}, 0.02 * step);
  return state;
}

VertexSettings bench_settings(double view_ms) {
  VertexSettings settings;
  settings.view_ms = view_ms;
  return settings;
}

enum class Surface { diffuse, glossy };

double products_ms(const VertexScene& scene, Surface surface) {
  VertexView view(*scene.mesh,
                  std::make_shared<const TriangleTree>(scene.mesh->positions, scene.mesh->triangles,
                                                       scene.name),
                  {kSide, kSide, scene.transport.highlight_count, {PixelPoint{}}});
  view.look(scene.camera, GBufferDetail::full);
  VertexLighting lighting(scene.transport);
  const auto lights =
      test::RandomVertices::light(surface == Surface::glossy ? 2 * kDegree : kDegree);
  const auto highlights =
      surface == Surface::glossy ? view.highlight_vertices() : std::span<const std::uint32_t>();
  return median_ms([&](int) {
    lighting.set_light(lights);
    lighting.light(view.vertices(), highlights);
  });
}

void change_light(benchmark::State& state, Surface surface) {
  auto scene =
      std::make_shared<VertexScene>(*scene_of_channels(static_cast<std::size_t>(state.range(0))));
  if (surface == Surface::diffuse) {
    for (VertexMaterial& material : scene->materials) material.highlight = {};
    scene->transport.highlight_count = 0;
    scene->transport.visibility = {};
  }
  const double alone = products_ms(*scene, surface);
  VertexRenderer renderer(scene, bench_settings(1e9));
  Rgb8Image frame;
  renderer.render_moving(turned_state(0), frame);
  Frames frames;
  int step = 0;
  for (auto _ : state) {
    const Stopwatch watch;
    const FrameReport report = renderer.render_moving(turned_state(++step), frame);
    frames.add(state, report, watch.elapsed_ms());
  }
  frames.say(state);
  state.counters["of_products"] = median(frames.whole) / alone;
}

Camera orbit(const Camera& start, int step) {
  Camera camera = start;
  camera.position = rotated(axis_angle({0, 1, 0}, 0.03 * step), start.position);
  return camera;
}

void change_view(benchmark::State& state, double view_ms) {
  const auto scene = scene_of_channels(1);
  VertexRenderer renderer(scene, bench_settings(view_ms));
  GBuffer rays(std::make_shared<const TriangleTree>(scene->mesh->positions, scene->mesh->triangles,
                                                    scene->name),
               kSide, kSide);
  const double alone = median_ms([&](int i) {
    rays.trace(orbit(scene->camera, i), view_ms > 0 ? GBufferDetail::full : GBufferDetail::coarse);
  });
  Rgb8Image frame;
  renderer.render_moving(turned_state(0), frame);
  Frames frames;
  DesignState design = turned_state(0);
  int step = 0;
  for (auto _ : state) {
    design.view = orbit(scene->camera, ++step);
    const Stopwatch watch;
    const FrameReport report = renderer.render_moving(design, frame);
    frames.add(state, report, watch.elapsed_ms());
  }
  frames.say(state);
  state.counters["of_rays"] = median(frames.whole) / alone;
}

void exact(benchmark::State& state, bool moves) {
  const auto scene = scene_of_channels(1);
  VertexRenderer renderer(scene, bench_settings(1e9));
  Rgb8Image frame;
  FrameReport report;
  DesignState design = turned_state(0);
  renderer.render_exact(design, frame, report);
  Frames frames;
  int step = 0;
  for (auto _ : state) {
    ++step;
    if (moves) {
      design.view = orbit(scene->camera, step);
    } else {
      design = turned_state(step);
    }
    const Stopwatch watch;
    renderer.render_exact(design, frame, report);
    frames.add(state, report, watch.elapsed_ms());
  }
  frames.say(state);
}

/// Frames under a turning light and a deadline, the first few apart: they teach it what parts take.
void keep_deadline(benchmark::State& state) {
  const auto ms = static_cast<double>(state.range(0));
  VertexSettings settings;
  settings.budget = {FrameBudget::Unit::milliseconds, ms};
  VertexRenderer renderer(scene_of_channels(1), settings);
  Rgb8Image frame;
  int step = 0;
  while (step < 10) renderer.render_moving(turned_state(++step), frame);
  Frames frames;
  std::vector<double> estimates;
  for (auto _ : state) {
    const Stopwatch watch;
    const FrameReport report = renderer.render_moving(turned_state(++step), frame);
    frames.add(state, report, watch.elapsed_ms());
    estimates.push_back(report.estimate_of_time.value_or(0));
  }
  frames.say(state);
  std::ranges::sort(frames.whole);
  const auto last = static_cast<double>(frames.whole.size() - 1);
  state.counters["p95_of_deadline"] = frames.whole[static_cast<std::size_t>(0.95 * last)] / ms;
  state.counters["worst_of_deadline"] = frames.whole.back() / ms;
  state.counters["estimate"] = median(estimates);
}

BENCHMARK(keep_deadline)->Arg(8)->Arg(12)->Arg(16)->Iterations(200)->UseManualTime();
BENCHMARK_CAPTURE(change_light, diffuse, Surface::diffuse)->Arg(1)->Arg(3)->UseManualTime();
BENCHMARK_CAPTURE(change_light, glossy, Surface::glossy)->Arg(1)->Arg(3)->UseManualTime();
BENCHMARK_CAPTURE(change_view, coarse, 0)->UseManualTime();
BENCHMARK_CAPTURE(change_view, full, 1e9)->UseManualTime();
BENCHMARK_CAPTURE(exact, light, false)->UseManualTime();
BENCHMARK_CAPTURE(exact, view, true)->UseManualTime();

}  // namespace
}  // namespace rimlight
