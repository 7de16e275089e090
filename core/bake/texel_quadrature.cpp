#include "core/bake/texel_quadrature.h"

namespace rimlight {

TexelQuadrature::TexelQuadrature(int cube_size)
    : size_(cube_size), quarters_(cube::texel_count(cube_size)) {
  const auto side = static_cast<std::size_t>(size_);
  for (std::size_t texel = 0; texel < quarters_.size(); ++texel) {
    const std::size_t face = texel / (side * side);
    const std::size_t row = texel / side % side;
    const std::size_t column = texel % side;
    for (std::size_t quarter = 0; quarter < kQuarters; ++quarter) {
      const std::size_t fine =
          (face * 2 * side + 2 * row + quarter / 2) * 2 * side + 2 * column + quarter % 2;
      quarters_[texel][quarter] = {Vec3f(cube::texel_direction(fine, 2 * size_)),
                                   static_cast<float>(cube::texel_solid_angle(fine, 2 * size_))};
    }
  }
}

TexelPatch TexelQuadrature::patch(std::size_t texel) const {
  const auto side = static_cast<std::size_t>(size_);
  const cube::FaceAxes& axes = cube::face_axes(static_cast<int>(texel / (side * side)));
  const double step = 2.0 / size_;
  const double x = step * static_cast<double>(texel % side) - 1;
  const double y = step * static_cast<double>(texel / side % side) - 1;
  return {texel, Vec3f(axes.axis + axes.right * x + axes.up * y), Vec3f(axes.right * step),
          Vec3f(axes.up * step), &quarters_[texel]};
}

}  // namespace rimlight
