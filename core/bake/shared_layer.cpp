#include "core/bake/shared_layer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rimlight {
namespace {

void find_viewers(const GroupSamples& samples, int ray, SharedLayer& layer) {
  layer.viewers.clear();
  for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
    const auto& hit = samples.hit(lane, ray);
    if (!hit) continue;
    const Frame<float> frame = hit->frame();
    layer.viewers.push_back({lane, &*hit, frame, frame.to_local(samples.out(lane, ray))});
  }
}

/// All layers of a group draw from one R2 sequence, so that a group's second points cover what its
/// pixels see evenly. `shift` makes each of them uniform.
void sample_points(const RayScene& scene, int ray, const LayerShift& shift, SharedLayer& layer) {
  layer.points.clear();
  for (std::size_t v = 0; v < layer.viewers.size(); ++v) {
    const SharedLayer::Viewer& viewer = layer.viewers[v];
    const int index = ray * static_cast<int>(kGroupLanes) + static_cast<int>(viewer.lane);
    const double choice = shift.choice + index * std::numbers::phi;
    const auto drawn =
        sample(viewer.hit->brdf, viewer.out, static_cast<float>(choice - std::floor(choice)),
               r2_point(shift.direction, index));
    if (!drawn) continue;
    const Vec3f direction = viewer.frame.to_world(drawn->direction);
    if (!leaves_front(*viewer.hit, direction)) continue;
    auto hit = scene.intersect({RayScene::ray_origin(*viewer.hit, direction), direction});
    if (hit) layer.points.push_back({*hit, v, -direction});
  }
}

/// Density and value of one pair, as if they saw each other; nothing when they cannot.
bool connect(const SharedLayer::Viewer& viewer, const SharedLayer::Point& point,
             SharedLayer::Pair& pair, Ray& ray, float& far) {
  const Vec3f apart = point.hit.position - viewer.hit->position;
  const float squared = dot(apart, apart);
  if (!(squared > 0)) return false;
  const Vec3f direction = apart / std::sqrt(squared);
  const float cosine_there = -dot(point.hit.geometric_normal, direction);
  if (!(cosine_there > 0) || !leaves_front(*viewer.hit, direction)) return false;
  const Vec3f in = viewer.frame.to_local(direction);
  const float to_area = cosine_there / squared;
  pair.density = density(viewer.hit->brdf, in, viewer.out) * to_area;
  pair.value = evaluate(viewer.hit->brdf, in, viewer.out) * (in.z * to_area);

  const Vec3f start = RayScene::ray_origin(*viewer.hit, direction);
  const Vec3f path = RayScene::ray_origin(point.hit, -direction) - start;
  const float distance = length(path);
  if (!(distance > 0)) return false;
  ray = {start, path / distance};
  constexpr float kShortOfTheEnd = 1 - 1e-4f;
  far = distance * kShortOfTheEnd;
  return true;
}

void find_pairs(const RayScene& scene, SharedLayer& layer) {
  layer.pairs.clear();
  layer.rays.clear();
  layer.far.clear();
  for (std::size_t p = 0; p < layer.points.size(); ++p) {
    for (std::size_t v = 0; v < layer.viewers.size(); ++v) {
      SharedLayer::Pair pair{v, p, 0, {}};
      Ray ray;
      float far = 0;
      if (!connect(layer.viewers[v], layer.points[p], pair, ray, far)) continue;
      layer.pairs.push_back(pair);
      layer.rays.push_back(ray);
      layer.far.push_back(far);
    }
  }
  layer.visible.resize(layer.rays.size());
  scene.visible(layer.rays, layer.far, layer.visible);
}

}  // namespace

bool leaves_front(const SurfaceHit& hit, const Vec3f& direction) {
  return dot(hit.geometric_normal, direction) > 0 && dot(hit.shading_normal, direction) > 0;
}

void make_shared_layer(const RayScene& scene, const GroupSamples& samples, int ray,
                       const LayerShift& shift, SharedLayer& layer) {
  find_viewers(samples, ray, layer);
  sample_points(scene, ray, shift, layer);
  find_pairs(scene, layer);
  layer.weights.assign(layer.points.size() * kRowLanes, 0.0f);
  layer.density_sum.assign(layer.points.size(), 0.0f);
  for (std::size_t i = 0; i < layer.pairs.size(); ++i) {
    const SharedLayer::Pair& pair = layer.pairs[i];
    // A point is in sight of the viewer that made it, whatever rounding says of the ray back.
    if (layer.points[pair.point].origin == pair.viewer) layer.visible[i] = 1;
    if (layer.visible[i] != 0) layer.density_sum[pair.point] += pair.density;
  }
  const float mean = 1.0f / static_cast<float>(samples.rays);
  for (std::size_t i = 0; i < layer.pairs.size(); ++i) {
    const SharedLayer::Pair& pair = layer.pairs[i];
    const float sum = layer.density_sum[pair.point];
    if (layer.visible[i] == 0 || !(sum > 0)) continue;
    const Vec3f weight = pair.value * (mean / sum);
    float* const weights = layer.weight(pair.point) + layer.viewers[pair.viewer].lane;
    for (int c = 0; c < 3; ++c) weights[static_cast<std::size_t>(c) * kGroupLanes] = weight[c];
  }
}

}  // namespace rimlight
