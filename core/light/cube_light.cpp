#include "core/light/cube_light.h"

namespace rimlight {

Vec3d integral(const CubeLight& light) {
  const std::size_t face_texels = light.count() / cube::kFaces;
  Vec3d sum;
  for (std::size_t i = 0; i < face_texels; ++i) {
    Vec3d radiance;  // of the six texels of this solid angle
    for (std::size_t face = 0; face < cube::kFaces; ++face) {
      radiance += Vec3d(light.at(face * face_texels + i));
    }
    sum += radiance * cube::texel_solid_angle(i, light.size);
  }
  return sum;
}

}  // namespace rimlight
