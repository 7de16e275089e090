#include "core/bake/group.h"

#include <algorithm>
#include <cmath>

#include "core/math/random.h"

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
  // The two irrational steps of the R2 sequence: powers of the inverse plastic number.
  constexpr double kStepX = 0.7548776662466927;
  constexpr double kStepY = 0.5698402909980532;
  const Camera& camera = scene.scene().camera;
  const Vec3f origin(camera.position);
  samples.rays = rays;
  samples.hits.assign(kGroupLanes * static_cast<std::size_t>(rays), std::nullopt);
  samples.outgoing.assign(samples.hits.size(), Vec3f{});
  for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
    const PixelLayout::Pixel pixel = layout.pixel(first_receiver + lane);
    if (pixel.x >= layout.width || pixel.y >= layout.height) continue;
    Random random(seed, first_receiver + lane);
    const double shift_x = random.uniform();
    const double shift_y = random.uniform();
    for (int ray = 0; ray < rays; ++ray) {
      const double x = pixel.x + std::fmod(shift_x + ray * kStepX, 1.0);
      const double y = pixel.y + std::fmod(shift_y + ray * kStepY, 1.0);
      const Vec3f direction(camera.ray_direction(x, y, layout.width, layout.height));
      const std::size_t index =
          lane * static_cast<std::size_t>(rays) + static_cast<std::size_t>(ray);
      samples.hits[index] = scene.intersect({origin, direction});
      samples.outgoing[index] = -direction;
    }
  }
}

}  // namespace rimlight
