#include "tests/support/path_tracer.h"

#include <cmath>

namespace rimlight::test {

TexelPathTracer::TexelPathTracer(const RayScene& scene, int cube_size, std::size_t texel,
                                 int bounces)
    : scene_(scene), cube_size_(cube_size), texel_(texel), bounces_(bounces) {}

Vec3f TexelPathTracer::direct(const SurfaceHit& hit, const Vec3f& out, Random& random) const {
  const auto side = static_cast<std::size_t>(cube_size_);
  const int face = static_cast<int>(texel_ / (side * side));
  const double x = 2 * (static_cast<double>(texel_ % side) + random.uniform()) / cube_size_ - 1;
  const double y =
      2 * (static_cast<double>(texel_ / side % side) + random.uniform()) / cube_size_ - 1;
  const Vec3f direction(cube::direction({face, x, y}));
  if (dot(direction, hit.geometric_normal) <= 0 || dot(direction, hit.shading_normal) <= 0)
    return {};
  const Ray ray{RayScene::ray_origin(hit, direction), direction};
  if (scene_.intersect(ray)) return {};
  const Frame<float> frame = hit.frame();
  const Vec3f in = frame.to_local(direction);
  const double area = 4.0 / (cube_size_ * cube_size_);
  const auto solid_angle = static_cast<float>(area * std::pow(1 + x * x + y * y, -1.5));
  return evaluate(hit.brdf, in, frame.to_local(out)) * (in.z * solid_angle);
}

Vec3f TexelPathTracer::sample_pixel(int x, int y, Random& random) const {
  const BakeSettings& bake = scene_.scene().bake;
  const Camera& camera = scene_.scene().camera;
  const double px = x + random.uniform();
  Ray ray{Vec3f(camera.position),
          Vec3f(camera.ray_direction(px, y + random.uniform(), bake.width, bake.height))};
  Vec3f throughput{1, 1, 1};
  Vec3f radiance;
  for (int bounce = 0; bounce <= bounces_; ++bounce) {
    const auto hit = scene_.intersect(ray);
    if (!hit) break;
    radiance += throughput * direct(*hit, -ray.direction, random);
    const Frame<float> frame = hit->frame();
    const float choice = random.uniform_float();
    const auto next =
        sample(hit->brdf, frame.to_local(-ray.direction), choice, random_sample(random));
    if (!next) break;
    const Vec3f direction = frame.to_world(next->direction);
    if (dot(direction, hit->geometric_normal) <= 0) break;
    throughput *= next->weight;
    ray = {RayScene::ray_origin(*hit, direction), direction};
  }
  return radiance;
}

}  // namespace rimlight::test
