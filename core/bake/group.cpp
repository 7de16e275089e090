#include "core/bake/group.h"

#include <algorithm>

#include "core/math/sampling.h"

namespace rimlight {

bool GroupSamples::empty() const {
  return std::none_of(hits.begin(), hits.end(), [](const auto& hit) { return hit.has_value(); });
}

float GroupSamples::coverage(std::size_t lane) const {
  int covered = 0;
  for (int ray = 0; ray < rays; ++ray) covered += hit(lane, ray).has_value() ? 1 : 0;
  return static_cast<float>(covered) / static_cast<float>(rays);
}

void sample_group(const RayScene& scene, const PixelLayout& layout, std::size_t first_receiver,
                  int rays, std::uint64_t seed, GroupSamples& samples) {
  const Camera& camera = scene.scene().camera;
  const Vec3f origin(camera.position);
  samples.rays = rays;
  samples.hits.assign(kGroupLanes * static_cast<std::size_t>(rays), std::nullopt);
  samples.outgoing.assign(samples.hits.size(), Vec3f{});
  for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
    const PixelLayout::Pixel pixel = layout.pixel(first_receiver + lane);
    if (pixel.x >= layout.width || pixel.y >= layout.height) continue;
    Random random(seed, first_receiver + lane);
    const Sample2 shift = random_sample(random);
    for (int ray = 0; ray < rays; ++ray) {
      const Sample2 at = r2_point(shift, ray);
      const Vec3f direction(
          camera.ray_direction(pixel.x + at.u, pixel.y + at.v, layout.width, layout.height));
      const std::size_t index =
          lane * static_cast<std::size_t>(rays) + static_cast<std::size_t>(ray);
      samples.hits[index] = scene.intersect({origin, direction});
      samples.outgoing[index] = -direction;
    }
  }
}

}  // namespace rimlight
