#include "tests/core/bake/random_samples.h"

#include "core/math/sampling.h"

namespace rimlight::test {
namespace {

Brdf random_brdf(bool lobes, Random& random) {
  Brdf brdf;
  brdf.albedo = {random.uniform_float(), random.uniform_float(), random.uniform_float()};
  const std::uint64_t model = lobes ? random.below(3) : 0;
  if (model == 0) return brdf;
  brdf.albedo *= 0.5f;
  brdf.specular = {0.5f, 0.4f, 0.3f};
  brdf.model = model == 1 ? BrdfModel::phong : BrdfModel::cook_torrance;
  return brdf;
}

SurfaceHit near_plane(const Vec3f& normal, const Brdf& brdf, Random& random) {
  SurfaceHit hit;
  const Frame<float> frame(normal);
  hit.position = frame.to_world(
      {static_cast<float>(random.uniform(-1, 1)), static_cast<float>(random.uniform(-1, 1)), 2});
  hit.geometric_normal = normal;
  const Vec3f bend(uniform_sphere(random_sample(random)));
  hit.shading_normal = normalized(normal + bend * 0.1f);
  hit.offset = 1e-4f;
  hit.brdf = brdf;
  return hit;
}

}  // namespace

GroupSamples random_samples(const SampleKind& kind, std::uint64_t seed) {
  Random random(seed);
  GroupSamples samples;
  samples.rays = kind.rays;
  for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
    const Vec3f normals[] = {Vec3f(uniform_sphere(random_sample(random))),
                             Vec3f(uniform_sphere(random_sample(random)))};
    const Brdf brdfs[] = {random_brdf(kind.lobes, random), random_brdf(kind.lobes, random)};
    const double hit_chance = lane % 8 == 3 ? 0 : lane % 8 == 5 ? 0.6 : 1;
    for (int ray = 0; ray < kind.rays; ++ray) {
      const std::size_t side = kind.edges && lane % 8 != 0 ? random.below(2) : 0;
      const bool hits = random.uniform() < hit_chance;
      const SurfaceHit hit = near_plane(normals[side], brdfs[side], random);
      samples.hits.push_back(hits ? std::optional(hit) : std::nullopt);
      const Vec3f aside(uniform_sphere(random_sample(random)));
      samples.outgoing.push_back(normalized(normals[side] * 1.5f + aside));
    }
  }
  return samples;
}

}  // namespace rimlight::test
