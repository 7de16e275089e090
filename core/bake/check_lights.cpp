#include "core/bake/check_lights.h"

#include <algorithm>
#include <utility>

#include "core/image/metrics.h"
#include "core/light/environment.h"
#include "core/light/light_rotation.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

constexpr int kRotations = 3;
constexpr std::uint64_t kRotationSeed = 0xc4ec;

/// One texel high up to the side, so that most scenes see it.
CubeLight one_texel(int size) {
  CubeLight light(size);
  const std::size_t texel = cube::texel_of({0.5, 1.0, 0.35}, size);
  for (int c = 0; c < 3; ++c) light.channel(c)[texel] = 1.0f;
  return light;
}

void add_turned(const CubeHaar& haar, const std::string& name, CubeLight texels,
                std::vector<CheckLight>& lights) {
  const std::size_t unrotated = lights.size();
  lights.push_back({name, to_coefficients(haar, texels), unrotated});
  Random random(kRotationSeed);
  LightRotator rotator(std::move(texels));
  CubeLight turned;
  for (int i = 1; i <= kRotations; ++i) {
    rotator.rotate(random_rotation(random), turned);
    lights.push_back(
        {name + " turned " + std::to_string(i), to_coefficients(haar, turned), unrotated});
  }
}

}  // namespace

std::vector<double> check_exposures(const std::vector<CheckLight>& lights,
                                    const LightImages& references) {
  std::vector<double> scales;
  for (const auto& reference : references) scales.push_back(auto_exposure_scale(reference));
  for (std::size_t i = 0; i < lights.size(); ++i) {
    scales[i] = std::min(scales[i], scales[lights[i].unrotated]);
  }
  return scales;
}

std::vector<CubeLight> coefficients_of(const std::vector<CheckLight>& lights) {
  std::vector<CubeLight> result;
  for (const CheckLight& light : lights) result.push_back(light.coefficients);
  return result;
}

CubeLight to_coefficients(const CubeHaar& haar, CubeLight texels) {
  CubeLight coefficients(haar.size());
  for (int c = 0; c < 3; ++c) haar.forward(texels.channel(c), coefficients.channel(c));
  return coefficients;
}

std::vector<CheckLight> make_check_lights(const CubeHaar& haar) {
  std::vector<CheckLight> lights;
  for (const char* const name : {"sunny", "cathedral"}) {
    add_turned(haar, name, builtin_environment(name).project(haar.size()), lights);
  }
  add_turned(haar, "one texel", one_texel(haar.size()), lights);
  return lights;
}

}  // namespace rimlight
