#include "core/light/cube_splat.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"

namespace rimlight {
namespace {

constexpr std::array kBorders = {cube::Border::right, cube::Border::left, cube::Border::top,
                                 cube::Border::bottom};

bool is_sideways(cube::Border border) {
  return border == cube::Border::right || border == cube::Border::left;
}
bool is_high(cube::Border border) {
  return border == cube::Border::right || border == cube::Border::top;
}

}  // namespace

CubeSplat::CubeSplat(int size) : size_(size), last_(1 - 1.0 / size) {
  RIMLIGHT_CHECK(size >= 2 && size <= cube::kLargestSize);
  for (int face = 0; face < cube::kFaces; ++face) {
    for (const cube::Border border : kBorders) {
      for (int i = 0; i < size; ++i) {
        beyond_.push_back(static_cast<std::uint32_t>(cube::texel_beyond(face, border, i, size)));
      }
    }
  }
}

std::uint32_t CubeSplat::texel(int face, int row, int column) const {
  return static_cast<std::uint32_t>((face * size_ + row) * size_ + column);
}

std::uint32_t CubeSplat::beyond(int face, cube::Border border, int index) const {
  const int place = (face * 4 + static_cast<int>(border)) * size_ + index;
  return beyond_[static_cast<std::size_t>(place)];
}

CubeSplat::Between CubeSplat::between(double x) const {
  const double place = (x + 1) / 2 * size_ - 0.5;
  const int low = std::clamp(static_cast<int>(place), 0, size_ - 2);
  return {low, std::clamp(place - low, 0.0, 1.0)};
}

SplatShares CubeSplat::shares(const cube::FacePoint& point) const {
  const double ax = std::abs(point.x), ay = std::abs(point.y);
  if (ax <= last_ && ay <= last_) {
    const Between x = between(point.x), y = between(point.y);
    const double x1 = x.next_share, x0 = 1 - x1, y1 = y.next_share, y0 = 1 - y1;
    const std::uint32_t low = texel(point.face, y.low, x.low);
    const std::uint32_t high = low + static_cast<std::uint32_t>(size_);
    return {{low, low + 1, high, high + 1},
            {static_cast<float>(x0 * y0), static_cast<float>(x1 * y0), static_cast<float>(x0 * y1),
             static_cast<float>(x1 * y1)}};
  }
  // Seen in the plane of the edge |x| = 1, a place (x, y) lies at y / (1 + |x|) along it, and the
  // middles of the border texels at y / (1 + last): scaled so that they keep their own y.
  const double along_x_edge = point.y * (1 + last_) / (1 + ax);
  if (ax > last_ && std::abs(along_x_edge) <= last_) {
    const auto border = point.x > 0 ? cube::Border::right : cube::Border::left;
    return across_edge(point.face, border, ax, along_x_edge);
  }
  const double along_y_edge = point.x * (1 + last_) / (1 + ay);
  if (ay > last_ && std::abs(along_y_edge) <= last_) {
    const auto border = point.y > 0 ? cube::Border::top : cube::Border::bottom;
    return across_edge(point.face, border, ay, along_y_edge);
  }
  return at_vertex(point);
}

SplatShares CubeSplat::across_edge(int face, cube::Border border, double across,
                                   double along) const {
  // In the edge's plane the place lies (1 − x) / (1 + x) from the edge, the middles on either side
  // at the same of `last`.
  const double distance = (1 - across) / (1 + across) * (1 + last_) / (1 - last_);
  const double far = std::clamp(0.5 * (1 - distance), 0.0, 0.5);
  const double near = 1 - far;
  const Between place = between(along);
  const double next = place.next_share, here = 1 - next;
  const int edge = is_high(border) ? size_ - 1 : 0;
  const auto near_texel = [&](int i) {
    return is_sideways(border) ? texel(face, i, edge) : texel(face, edge, i);
  };
  return {{near_texel(place.low), near_texel(place.low + 1), beyond(face, border, place.low),
           beyond(face, border, place.low + 1)},
          {static_cast<float>(near * here), static_cast<float>(near * next),
           static_cast<float>(far * here), static_cast<float>(far * next)}};
}

SplatShares CubeSplat::at_vertex(const cube::FacePoint& point) const {
  // The three middles are (l, l, 1), (1, l, l), (l, 1, l) in the axes of the vertex; solve
  // (|x|, |y|, 1) = Σ shares · middles: with S their sum, |x| = l·S + (1 − l)·(share of the
  // second).
  const double ax = std::abs(point.x), ay = std::abs(point.y);
  const double sum = (1 + ax + ay) / (1 + 2 * last_);
  const double here = std::max(1 - last_ * sum, 0.0);
  const double beyond_x = std::max(ax - last_ * sum, 0.0);
  const double beyond_y = std::max(ay - last_ * sum, 0.0);
  const double scale = 1 / (here + beyond_x + beyond_y);
  const int column = point.x > 0 ? size_ - 1 : 0;
  const int row = point.y > 0 ? size_ - 1 : 0;
  const auto x_border = point.x > 0 ? cube::Border::right : cube::Border::left;
  const auto y_border = point.y > 0 ? cube::Border::top : cube::Border::bottom;
  const std::uint32_t own = texel(point.face, row, column);
  return {{own, beyond(point.face, x_border, row), beyond(point.face, y_border, column), own},
          {static_cast<float>(here * scale), static_cast<float>(beyond_x * scale),
           static_cast<float>(beyond_y * scale), 0}};
}

}  // namespace rimlight
