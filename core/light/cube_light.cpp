#include "core/light/cube_light.h"

namespace rimlight {

Vec3d integral(const CubeLight& light) {
  Vec3d sum;
  for (std::size_t texel = 0; texel < light.count(); ++texel) {
    sum += Vec3d(light.at(texel)) * cube::texel_solid_angle(texel, light.size);
  }
  return sum;
}

}  // namespace rimlight
