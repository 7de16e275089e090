#pragma once

#include <cstddef>

#include "core/base/aligned_vector.h"
#include "core/math/vec.h"

namespace rimlight {

/// The cube map: six faces of size × size texels, seen from the origin. Conventions, stated once:
///
///   faces    0 … 5 = +x, −x, +y, −y, +z, −z
///   a face   direction ∝ axis + x·right + y·up with x, y in [−1, 1] and right × up = axis
///   a texel  column c covers x in [2c/size − 1, 2(c+1)/size − 1], row r the same in y
///   index    (face · size + row) · size + column
///   dω       = dx dy / (1 + x² + y²)^(3/2)
namespace cube {

inline constexpr int kFaces = 6;
inline constexpr int kSmallestSize = 1;
inline constexpr int kLargestSize = 512;

struct FaceAxes {
  Vec3d axis, right, up;
};
const FaceAxes& face_axes(int face);

/// A point of a face's plane.
struct FacePoint {
  int face = 0;
  double x = 0, y = 0;
};

constexpr std::size_t texel_count(int size) {
  return static_cast<std::size_t>(kFaces) * static_cast<std::size_t>(size) *
         static_cast<std::size_t>(size);
}

/// The unit direction of a point of a face.
Vec3d direction(const FacePoint& point);

/// Where a direction (any length but zero) meets the cube; ties go to the lower axis.
FacePoint face_point(const Vec3d& direction);

/// The texel that a direction falls into.
std::size_t texel_of(const Vec3d& direction, int size);

/// The unit direction of a texel's middle.
Vec3d texel_direction(std::size_t texel, int size);

/// The borders of a face: where x = 1, x = −1, y = 1, y = −1.
enum class Border { right, left, top, bottom };

/// The texel on the other side of a face's border from the border texel with this `index` along it
/// (its row at right and left, its column at top and bottom).
std::size_t texel_beyond(int face, Border border, int index, int size);

/// ∫ dω over the rectangle from the face's middle to (x, y), signed: atan(xy / √(1 + x² + y²)).
double corner_solid_angle(double x, double y);

/// The exact solid angle of a texel. Over all texels of a cube it sums to 4π.
double texel_solid_angle(std::size_t texel, int size);

/// All texels' solid angles: [texel_count(size)].
AlignedVector<float> texel_solid_angles(int size);

}  // namespace cube
}  // namespace rimlight
