#include <benchmark/benchmark.h>

#include <chrono>
#include <memory>
#include <vector>

#include "core/bake/direct_transport.h"
#include "core/bake/lambert_kernel.h"
#include "core/bake/sky_visibility.h"
#include "core/math/random.h"
#include "core/scene/terrace.h"

namespace rimlight {
namespace {

constexpr std::size_t kGroups = 12;
constexpr int kPrimaryRays = 16;

const RayScene& terrace_rays() {
  static const RayScene rays(std::make_shared<const Scene>(terrace::make_scene(1)));
  return rays;
}

/// Groups of a 512×512 picture, anywhere, that see something.
const std::vector<GroupSamples>& terrace_groups() {
  static const auto groups = [] {
    const PixelLayout layout{512, 512};
    Random random(1);
    std::vector<GroupSamples> result;
    while (result.size() < kGroups) {
      const std::size_t group = random.below(layout.receiver_count() / kGroupLanes);
      GroupSamples samples;
      sample_group(terrace_rays(), layout, group * kGroupLanes, kPrimaryRays, 1, samples);
      if (!samples.empty()) result.push_back(samples);
    }
    return result;
  }();
  return groups;
}

/// A group's shadow rays, in the order in which they are traced.
struct RecordedRays {
  Coherence coherence = Coherence::low;
  std::vector<Ray> rays;  // directions not of unit length
};

void record(const ShadowRayRequest& request, ShadowRays& batch, RecordedRays& recorded) {
  if (request.lanes == 0) return;
  batch.rays.count = 0;
  add_shadow_rays(request, batch);
  const auto& o = batch.rays.origin;
  const auto& d = batch.rays.direction;
  for (std::size_t i = 0; i < batch.rays.count; ++i) {
    recorded.rays.push_back({{o[0][i], o[1][i], o[2][i]}, {d[0][i], d[1][i], d[2][i]}});
  }
}

RecordedRays record_rays(const GroupSamples& samples, std::uint64_t seed, int cube_size) {
  const TexelQuadrature texels(cube_size);
  const auto visibility = std::make_unique<SkyVisibility>();
  const auto batch = std::make_unique<ShadowRays>();
  GroupSurfaces surfaces;
  surfaces.assign(samples);
  visibility->clear(surfaces.layer_count(), texels);
  for (std::size_t i = 0; i < surfaces.layer_count(); ++i) {
    for (std::size_t texel = 0; texel < texels.count(); ++texel) {
      visibility->responding(i, texel) = facing_lanes(surfaces.layer(i), texels.quarters(texel));
    }
  }
  visibility->trace(terrace_rays(), surfaces, texels, mix_bits(seed));
  RecordedRays recorded{shadow_ray_coherence(surfaces), {}};
  for (const bool more : {false, true}) {
    for (std::size_t texel = 0; texel < texels.count(); ++texel) {
      for (std::size_t i = 0; i < surfaces.layer_count(); ++i) {
        record({surfaces, i, texels.patch(texel),
                more ? visibility->refined(i, texel) : visibility->responding(i, texel),
                more ? 1 : 0, more ? SkyVisibility::kMoreShadowRays : 1, 0, mix_bits(seed)},
               *batch, recorded);
      }
    }
  }
  return recorded;
}

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// How long Embree takes for the rays alone.
double trace_alone(const RecordedRays& recorded) {
  static const auto sky = std::make_unique<SkyRays>();
  std::vector<std::uint8_t> visible(SkyRays::kCapacity);
  double seconds = 0;
  for (std::size_t begin = 0; begin < recorded.rays.size(); begin += SkyRays::kCapacity) {
    sky->count = std::min(SkyRays::kCapacity, recorded.rays.size() - begin);
    for (std::size_t i = 0; i < sky->count; ++i) {
      for (int c = 0; c < 3; ++c) {
        const auto axis = static_cast<std::size_t>(c);
        sky->origin[axis][i] = recorded.rays[begin + i].origin[c];
        sky->direction[axis][i] = recorded.rays[begin + i].direction[c];
      }
    }
    const auto start = Clock::now();
    terrace_rays().visible(*sky, recorded.coherence, visible);
    seconds += seconds_since(start);
    benchmark::DoNotOptimize(visible.data());
  }
  return seconds;
}

/// The direct transport of groups, and of that the limit: Embree alone with the same rays, group by
/// group in turn.
void add_direct(benchmark::State& state) {
  const auto cube_size = static_cast<int>(state.range(0));
  const DirectTransport direct(terrace_rays(), cube_size);
  GroupRows rows(cube_size);
  double add_seconds = 0, trace_seconds = 0, rays = 0;
  std::size_t i = 0;
  for (auto _ : state) {
    const GroupSamples& samples = terrace_groups()[i++ % kGroups];
    const auto start = Clock::now();
    direct.add(samples, i, rows);
    const double seconds = seconds_since(start);
    benchmark::DoNotOptimize(rows.values.data());
    state.SetIterationTime(seconds);
    add_seconds += seconds;
    const RecordedRays recorded = record_rays(samples, i, cube_size);
    trace_seconds += trace_alone(recorded);
    rays += static_cast<double>(recorded.rays.size());
  }
  state.counters["rays/s"] = rays / add_seconds;
  state.counters["Embree_rays/s"] = rays / trace_seconds;
  state.counters["of_limit"] = trace_seconds / add_seconds;
}
BENCHMARK(add_direct)
    ->ArgName("cube_size")
    ->Arg(32)
    ->Arg(64)
    ->Iterations(kGroups)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rimlight
