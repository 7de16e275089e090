#include "core/basis/sh_directions.h"

#include <algorithm>

#include "core/base/check.h"

namespace rimlight::sh {

Directions::Directions(std::span<const Vec3d> directions)
    : x_(padded(directions.size()), 0.0f),
      y_(padded(directions.size()), 0.0f),
      z_(padded(directions.size()), 1.0f),
      count_(directions.size()) {
  for (std::size_t i = 0; i < count_; ++i) {
    x_[i] = static_cast<float>(directions[i].x);
    y_[i] = static_cast<float>(directions[i].y);
    z_[i] = static_cast<float>(directions[i].z);
  }
}

DirectionSpans Directions::part(std::size_t first, std::size_t count) const {
  RIMLIGHT_CHECK_EQ(first % kDirectionLanes, std::size_t{0});
  RIMLIGHT_CHECK(first <= x_.size());
  const std::size_t size = std::min(padded(count), x_.size() - first);
  const auto cut = [&](const AlignedVector<float>& all) {
    return std::span<const float>(all).subspan(first, size);
  };
  return {cut(x_), cut(y_), cut(z_)};
}

}  // namespace rimlight::sh
