#include "core/bake/check_lights.h"

#include <utility>

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
  lights.push_back({name, to_coefficients(haar, texels)});
  Random random(kRotationSeed);
  LightRotator rotator(std::move(texels));
  CubeLight turned;
  for (int i = 1; i <= kRotations; ++i) {
    rotator.rotate(random_rotation(random), turned);
    lights.push_back({name + " turned " + std::to_string(i), to_coefficients(haar, turned)});
  }
}

}  // namespace

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
