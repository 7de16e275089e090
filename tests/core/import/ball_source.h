#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "core/bake/group.h"
#include "core/import/transport_source.h"
#include "core/math/vec.h"

namespace rimlight {

/// A white Lambert ball in parallel projection before black: pixels' transport in closed form,
/// T(ω) = max(n·ω, 0) / π.
class BallSource : public TransportSource {
 public:
  BallSource(std::vector<Vec3d> directions, int width, int height)
      : directions_(std::move(directions)), pixels_{width, height} {}

  PixelLayout pixels() const override { return pixels_; }
  std::size_t direction_count() const override { return directions_.size(); }

  static Vec3d normal(const PixelLayout& pixels, int x, int y) {
    const double u = (x + 0.5) / pixels.width * 2 - 1, v = 1 - (y + 0.5) / pixels.height * 2;
    const double square = u * u + v * v;
    return square < 1 ? Vec3d(u, v, std::sqrt(1 - square)) : Vec3d();
  }

  void read_group(std::size_t first_receiver, std::span<float> rows) const override {
    std::fill(rows.begin(), rows.end(), 0.0f);
    for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
      const auto [x, y] = pixels_.pixel(first_receiver + lane);
      if (x >= pixels_.width || y >= pixels_.height) continue;
      const Vec3d n = normal(pixels_, x, y);
      for (std::size_t i = 0; i < directions_.size(); ++i) {
        const double cosine = std::max(dot(n, directions_[i]), 0.0);
        for (std::size_t c = 0; c < 3; ++c) {
          rows[i * kRowLanes + c * kGroupLanes + lane] =
              static_cast<float>(cosine / std::numbers::pi);
        }
      }
    }
  }

 private:
  std::vector<Vec3d> directions_;
  PixelLayout pixels_;
};

}  // namespace rimlight
