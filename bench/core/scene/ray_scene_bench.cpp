#include <benchmark/benchmark.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "core/math/random.h"
#include "core/math/sampling.h"
#include "core/scene/ray_scene.h"
#include "core/scene/terrace.h"

namespace rimlight {
namespace {

const RayScene& terrace_rays() {
  static const RayScene rays(std::make_shared<const Scene>(terrace::make_scene(1)));
  return rays;
}

/// What the camera sees, in random order.
std::vector<SurfaceHit> camera_hits(std::size_t count) {
  Random random(1);
  const Camera& camera = terrace_rays().scene().camera;
  std::vector<SurfaceHit> hits;
  while (hits.size() < count) {
    const Vec3d way =
        camera.ray_direction(random.uniform(0, 512), random.uniform(0, 512), 512, 512);
    if (const auto hit = terrace_rays().intersect({Vec3f(camera.position), Vec3f(way)})) {
      hits.push_back(*hit);
    }
  }
  return hits;
}

/// Uniform hemispheres about the hits: the shadow rays of a bake.
std::vector<Ray> hemisphere_rays(std::size_t hits, std::size_t rays_each) {
  Random random(2);
  std::vector<Ray> rays;
  for (const SurfaceHit& hit : camera_hits(hits)) {
    for (std::size_t i = 0; i < rays_each; ++i) {
      Vec3f way(uniform_sphere(random_sample(random)));
      if (dot(way, hit.geometric_normal) < 0) way = -way;
      rays.push_back({RayScene::ray_origin(hit, way), way});
    }
  }
  return rays;
}

/// LIMITS' rival: 7.7 million rays a second on one thread, a scene of 163,202 triangles.
void visible(benchmark::State& state) {
  const std::vector<Ray> rays = hemisphere_rays(400, 500);
  std::vector<std::uint8_t> result(rays.size());
  for (auto _ : state) {
    terrace_rays().visible(rays, {}, result);
    benchmark::DoNotOptimize(result.data());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(rays.size()));
}
BENCHMARK(visible)->UseRealTime();

void intersect_camera_rays(benchmark::State& state) {
  const Camera& camera = terrace_rays().scene().camera;
  std::size_t i = 0;
  for (auto _ : state) {
    const Vec3d way = camera.ray_direction(static_cast<double>(i % 512),
                                           static_cast<double>(i / 512 % 512), 512, 512);
    benchmark::DoNotOptimize(terrace_rays().intersect({Vec3f(camera.position), Vec3f(way)}));
    ++i;
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(intersect_camera_rays)->UseRealTime();

void build_tree(benchmark::State& state) {
  const auto scene = std::make_shared<const Scene>(terrace::make_scene(1));
  for (auto _ : state) benchmark::DoNotOptimize(RayScene(scene).extent());
}
BENCHMARK(build_tree)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace rimlight
