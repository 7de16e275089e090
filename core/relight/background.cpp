#include "core/relight/background.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/check.h"
#include "core/basis/cube_map.h"

namespace rimlight {
namespace {

/// Vec3f texels of one face by rows and columns of its bordered form.
class BorderedFace {
 public:
  BorderedFace(float* texels, int size) : texels_(texels), side_(size + 2) {}

  Vec3f get(int row, int column) const {
    const float* const texel = at(row, column);
    return {texel[0], texel[1], texel[2]};
  }
  void put(int row, int column, const Vec3f& radiance) const {
    for (int c = 0; c < 3; ++c) at(row, column)[c] = radiance[c];
  }

 private:
  float* at(int row, int column) const { return texels_ + 4 * (row * side_ + column); }

  float* texels_;
  int side_;
};

/// Three faces meet at a corner: there stands the mean of their three texels.
void fill_corners(const BorderedFace& face, int size) {
  const int last = size + 1;
  for (const int row : {0, last}) {
    for (const int column : {0, last}) {
      const int near_row = row == 0 ? 1 : size, near_column = column == 0 ? 1 : size;
      face.put(row, column,
               (face.get(near_row, near_column) + face.get(row, near_column) +
                face.get(near_row, column)) /
                   3.0f);
    }
  }
}

}  // namespace

BackgroundMap::BackgroundMap(const CubeLight& texels)
    : size_(texels.size),
      texels_(4 * static_cast<std::size_t>(cube::kFaces) * static_cast<std::size_t>(size_ + 2) *
              static_cast<std::size_t>(size_ + 2)) {
  const int last = size_ + 1;
  for (int face = 0; face < cube::kFaces; ++face) {
    const BorderedFace bordered(texels_.data() + 4 * face * (size_ + 2) * (size_ + 2), size_);
    const auto beyond = [&](cube::Border border, int index) {
      return texels.at(cube::texel_beyond(face, border, index, size_));
    };
    for (int i = 0; i < size_; ++i) {
      for (int column = 0; column < size_; ++column) {
        const int index = (face * size_ + i) * size_ + column;
        bordered.put(i + 1, column + 1, texels.at(static_cast<std::size_t>(index)));
      }
      bordered.put(i + 1, last, beyond(cube::Border::right, i));
      bordered.put(i + 1, 0, beyond(cube::Border::left, i));
      bordered.put(last, i + 1, beyond(cube::Border::top, i));
      bordered.put(0, i + 1, beyond(cube::Border::bottom, i));
    }
    fill_corners(bordered, size_);
  }
}

Vec3f BackgroundMap::at(const Vec3f& direction) const {
  BackgroundLookUps one;
  std::ranges::fill(one.x, direction.x);
  std::ranges::fill(one.y, direction.y);
  std::ranges::fill(one.z, direction.z);
  look_up(faces(), {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 1, one);
  return {one.radiance[0][0], one.radiance[0][1], one.radiance[0][2]};
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
