#include "core/relight/background.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/check.h"
#include "core/basis/cube_map.h"

namespace rimlight {
namespace {

struct FaceCoordinates {
  int face;
  float x, y;
};

/// cube::face_point in floats: on every face right and up are positive axes, in turn on the faces
/// of positive axes, in the other order on those of negative ones (right × up = axis).
FaceCoordinates face_coordinates(const Vec3f& d) {
  const float ax = std::abs(d.x), ay = std::abs(d.y), az = std::abs(d.z);
  if (ax >= ay && ax >= az) {
    return d.x >= 0 ? FaceCoordinates{0, d.y / ax, d.z / ax}
                    : FaceCoordinates{1, d.z / ax, d.y / ax};
  }
  if (ay >= az) {
    return d.y >= 0 ? FaceCoordinates{2, d.z / ay, d.x / ay}
                    : FaceCoordinates{3, d.x / ay, d.z / ay};
  }
  return d.z >= 0 ? FaceCoordinates{4, d.x / az, d.y / az} : FaceCoordinates{5, d.y / az, d.x / az};
}

Vec3f mix(const Vec3f& a, const Vec3f& b, float t) { return a + (b - a) * t; }

}  // namespace

BackgroundMap::BackgroundMap(const CubeLight& texels)
    : size_(texels.size),
      side_(texels.size + 2),
      texels_(static_cast<std::size_t>(cube::kFaces) * static_cast<std::size_t>(side_) *
              static_cast<std::size_t>(side_)) {
  const auto put = [this](int face, int row, int column) -> Vec3f& {
    return const_cast<Vec3f&>(texel(face, row, column));
  };
  const int last = size_ + 1;
  for (int face = 0; face < cube::kFaces; ++face) {
    const auto beyond = [&](cube::Border border, int index) {
      return texels.at(cube::texel_beyond(face, border, index, size_));
    };
    for (int i = 0; i < size_; ++i) {
      for (int column = 0; column < size_; ++column) {
        const int index = (face * size_ + i) * size_ + column;
        put(face, i + 1, column + 1) = texels.at(static_cast<std::size_t>(index));
      }
      put(face, i + 1, last) = beyond(cube::Border::right, i);
      put(face, i + 1, 0) = beyond(cube::Border::left, i);
      put(face, last, i + 1) = beyond(cube::Border::top, i);
      put(face, 0, i + 1) = beyond(cube::Border::bottom, i);
    }
    // Three faces meet at a corner: there stands the mean of their three texels.
    for (const int row : {0, last}) {
      for (const int column : {0, last}) {
        const int near_row = row == 0 ? 1 : size_, near_column = column == 0 ? 1 : size_;
        put(face, row, column) = (texel(face, near_row, near_column) +
                                  texel(face, row, near_column) + texel(face, near_row, column)) /
                                 3.0f;
      }
    }
  }
}

Vec3f BackgroundMap::at(const Vec3f& direction) const {
  const FaceCoordinates point = face_coordinates(direction);
  // The middle of texel c lies at c + 1 of the bordered face.
  const auto half = static_cast<float>(size_) / 2;
  const float x = (point.x + 1) * half + 0.5f, y = (point.y + 1) * half + 0.5f;
  const int column = std::clamp(static_cast<int>(x), 0, size_);
  const int row = std::clamp(static_cast<int>(y), 0, size_);
  const float s = x - static_cast<float>(column), t = y - static_cast<float>(row);
  return mix(mix(texel(point.face, row, column), texel(point.face, row, column + 1), s),
             mix(texel(point.face, row + 1, column), texel(point.face, row + 1, column + 1), s), t);
}

BackgroundPixels::BackgroundPixels(const PixelLayout& layout, const Camera& camera,
                                   std::span<const float> coverage) {
  RIMLIGHT_CHECK_EQ(coverage.size(), static_cast<std::size_t>(layout.width) *
                                         static_cast<std::size_t>(layout.height));
  const CameraRays rays(camera, layout.width, layout.height);
  first_.push_back(0);
  for (int top = 0; top < layout.height; top += PixelLayout::kTileSide) {
    for (int left = 0; left < layout.width; left += PixelLayout::kTileSide) {
      const int bottom = std::min(top + PixelLayout::kTileSide, layout.height);
      const int right = std::min(left + PixelLayout::kTileSide, layout.width);
      for (int y = top; y < bottom; ++y) {
        for (int x = left; x < right; ++x) {
          const int index = y * layout.width + x;
          const float share = 1 - coverage[static_cast<std::size_t>(index)];
          if (!(share > 0)) continue;
          pixels_.push_back({static_cast<std::uint16_t>(x - left),
                             static_cast<std::uint16_t>(y - top), share,
                             Vec3f(rays.direction(x + 0.5, y + 0.5))});
        }
      }
      first_.push_back(pixels_.size());
    }
  }
}

}  // namespace rimlight
