#include "core/scene/transform.h"

namespace rimlight {
namespace {

Matrix3 transposed(const Matrix3& m) {
  return {{{m.row[0].x, m.row[1].x, m.row[2].x},
           {m.row[0].y, m.row[1].y, m.row[2].y},
           {m.row[0].z, m.row[1].z, m.row[2].z}}};
}

}  // namespace

Vec3d Transform::normal(const Vec3d& n) const {
  const Matrix3 cofactors{{cross(linear.row[1], linear.row[2]), cross(linear.row[2], linear.row[0]),
                           cross(linear.row[0], linear.row[1])}};
  return cofactors * n;
}

Transform translation(const Vec3d& by) {
  Transform result;
  result.offset = by;
  return result;
}

Transform scaling(const Vec3d& by) {
  Transform result;
  result.linear = {{{by.x, 0, 0}, {0, by.y, 0}, {0, 0, by.z}}};
  return result;
}

Transform rotation(const Quaternion& by) {
  Transform result;
  result.linear = matrix(by);
  return result;
}

Transform operator*(const Transform& a, const Transform& b) {
  const Matrix3 columns = transposed(b.linear);
  Transform result;
  // Columns of the product are a's images of b's columns; rows of their transpose.
  result.linear = transposed(
      {{a.linear * columns.row[0], a.linear * columns.row[1], a.linear * columns.row[2]}});
  result.offset = a.point(b.offset);
  return result;
}

void apply(const Transform& transform, Mesh& mesh) {
  for (Vec3f& position : mesh.positions) position = Vec3f(transform.point(Vec3d(position)));
  for (Vec3f& normal : mesh.normals) {
    const Vec3d turned = transform.normal(Vec3d(normal));
    const double size = length(turned);
    normal = size > 0 ? Vec3f(turned / size) : Vec3f();
  }
}

}  // namespace rimlight
