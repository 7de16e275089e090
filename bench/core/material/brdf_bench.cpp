#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "core/material/brdf.h"
#include "core/math/random.h"
#include "core/math/sampling.h"

namespace rimlight {
namespace {

/// Pairs of directions, enough that none is predicted, few enough to stay in L1.
std::vector<Vec3f> directions() {
  Random random(1);
  std::vector<Vec3f> result;
  for (int i = 0; i < 1024; ++i) result.emplace_back(cosine_hemisphere(random_sample(random)));
  return result;
}

Brdf material(int which) {
  Brdf brdf{.albedo = {0.6f, 0.5f, 0.4f}};
  if (which == 0) return brdf;
  brdf.specular = {0.4f, 0.4f, 0.4f};
  constexpr BrdfModel kModels[] = {BrdfModel::lambert,          BrdfModel::phong,
                                   BrdfModel::cook_torrance,    BrdfModel::cook_torrance,
                                   BrdfModel::blinn_phong,      BrdfModel::ward,
                                   BrdfModel::ashikhmin_shirley};
  brdf.model = kModels[which];
  if (which == 3) {
    brdf.albedo = {};
    brdf.eta = {0.18f, 0.42f, 1.37f};
    brdf.k = {3.42f, 2.35f, 1.77f};
  }
  return brdf;
}

void evaluate_brdf(benchmark::State& state) {
  const Brdf brdf = material(static_cast<int>(state.range(0)));
  const std::vector<Vec3f> in = directions();
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(evaluate(brdf, in[i % 1024], in[(i + 7) % 1024]));
    ++i;
  }
}
BENCHMARK(evaluate_brdf)
    ->ArgName("0_lambert_1_phong_2_glaze_3_gold_4_blinn_5_ward_6_ashikhmin")
    ->DenseRange(0, 6)
    ->UseRealTime();

void sample_brdf(benchmark::State& state) {
  const Brdf brdf = material(static_cast<int>(state.range(0)));
  const std::vector<Vec3f> out = directions();
  Random random(2);
  std::size_t i = 0;
  for (auto _ : state) {
    const float choice = random.uniform_float();
    benchmark::DoNotOptimize(sample(brdf, out[i++ % 1024], choice, random_sample(random)));
  }
}
BENCHMARK(sample_brdf)
    ->ArgName("0_lambert_1_phong_2_glaze_3_gold_4_blinn_5_ward_6_ashikhmin")
    ->DenseRange(0, 6)
    ->UseRealTime();

}  // namespace
}  // namespace rimlight
