#include "core/basis/cube_map.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rimlight::cube {

const FaceAxes& face_axes(int face) {
  static const std::array<FaceAxes, kFaces> kAxes = {{
      {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
      {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
      {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}},
      {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
      {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}},
      {{0, 0, -1}, {0, 1, 0}, {1, 0, 0}},
  }};
  return kAxes[static_cast<std::size_t>(face)];
}

Vec3d direction(const FacePoint& point) {
  const FaceAxes& axes = face_axes(point.face);
  return normalized(axes.axis + axes.right * point.x + axes.up * point.y);
}

FacePoint face_point(const Vec3d& direction) {
  const double ax = std::abs(direction.x), ay = std::abs(direction.y), az = std::abs(direction.z);
  const int axis = ax >= ay && ax >= az ? 0 : ay >= az ? 1 : 2;
  const int face = 2 * axis + (direction[axis] < 0 ? 1 : 0);
  const FaceAxes& axes = face_axes(face);
  const double depth = dot(direction, axes.axis);
  return {face, dot(direction, axes.right) / depth, dot(direction, axes.up) / depth};
}

std::size_t texel_of(const Vec3d& direction, int size) {
  const FacePoint point = face_point(direction);
  const auto cell = [size](double x) {
    return std::clamp(static_cast<int>((x + 1) / 2 * size), 0, size - 1);
  };
  const int texel = (point.face * size + cell(point.y)) * size + cell(point.x);
  return static_cast<std::size_t>(texel);
}

namespace {
struct TexelPlace {
  int face, row, column;
};
TexelPlace place_of(std::size_t texel, int size) {
  const int index = static_cast<int>(texel);
  return {index / (size * size), index / size % size, index % size};
}
}  // namespace

Vec3d texel_direction(std::size_t texel, int size) {
  const TexelPlace place = place_of(texel, size);
  return direction(
      {place.face, (2 * place.column + 1.0) / size - 1, (2 * place.row + 1.0) / size - 1});
}

std::size_t texel_beyond(int face, Border border, int index, int size) {
  // A quarter of a texel beyond the border: inside the neighbour's border texel, for its width as
  // seen from here is about the texel's own.
  const double beyond = 1 + 0.5 / size;
  const double along = (2 * index + 1.0) / size - 1;
  const bool sideways = border == Border::right || border == Border::left;
  const double across = border == Border::right || border == Border::top ? beyond : -beyond;
  const FaceAxes& axes = face_axes(face);
  // Scaled by `beyond`, so that the place along the border is the same on both faces.
  return texel_of(axes.axis + (sideways ? axes.right : axes.up) * across +
                      (sideways ? axes.up : axes.right) * (along * beyond),
                  size);
}

double corner_solid_angle(double x, double y) {
  return std::atan2(x * y, std::sqrt(1 + x * x + y * y));
}

double texel_solid_angle(std::size_t texel, int size) {
  const TexelPlace place = place_of(texel, size);
  const double x0 = 2.0 * place.column / size - 1, x1 = 2.0 * (place.column + 1) / size - 1;
  const double y0 = 2.0 * place.row / size - 1, y1 = 2.0 * (place.row + 1) / size - 1;
  return corner_solid_angle(x1, y1) - corner_solid_angle(x0, y1) - corner_solid_angle(x1, y0) +
         corner_solid_angle(x0, y0);
}

AlignedVector<float> texel_solid_angles(int size) {
  AlignedVector<float> angles(texel_count(size));
  for (std::size_t texel = 0; texel < angles.size(); ++texel) {
    angles[texel] = static_cast<float>(texel_solid_angle(texel, size));
  }
  return angles;
}

}  // namespace rimlight::cube
