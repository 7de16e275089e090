#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/light/cube_light.h"
#include "core/math/random.h"

namespace rimlight {

/// A light of one value everywhere, a different one in each channel.
inline CubeLight uniform_light(int size, float radiance = 1) {
  CubeLight light(size);
  for (int c = 0; c < 3; ++c) {
    std::fill(light.channel(c).begin(), light.channel(c).end(),
              radiance * (1 + 0.25f * static_cast<float>(c)));
  }
  return light;
}

inline CubeLight random_light(int size, Random& random) {
  CubeLight light(size);
  for (float& value : light.values) value = random.uniform_float();
  return light;
}

/// Black but for one texel.
inline CubeLight lit_texel(int size, std::size_t texel, float radiance = 1) {
  CubeLight light(size);
  for (int c = 0; c < 3; ++c) light.channel(c)[texel] = radiance;
  return light;
}

/// Black and white by turns, `width` texels wide.
inline CubeLight checkerboard(int size, int width) {
  CubeLight light(size);
  for (std::size_t texel = 0; texel < light.count(); ++texel) {
    const int index = static_cast<int>(texel);
    const bool white = (index % size / width + index / size % size / width) % 2 == 0;
    for (int c = 0; c < 3; ++c) light.channel(c)[texel] = white ? 1.0f : 0.0f;
  }
  return light;
}

/// The texel of a face's row and column.
inline std::size_t texel_at(int size, int face, int row, int column) {
  return static_cast<std::size_t>((face * size + row) * size + column);
}

/// The largest relative difference of two integrals, over channels.
inline double relative_difference(const Vec3d& value, const Vec3d& truth) {
  double worst = 0;
  for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(value[c] / truth[c] - 1));
  return worst;
}

/// All texels' middles and solid angles, computed once for each size that a test asks for.
struct TexelGeometry {
  std::vector<Vec3d> direction;
  std::vector<double> solid_angle;
};
inline const TexelGeometry& texel_geometry(int size) {
  static std::map<int, TexelGeometry> known;
  TexelGeometry& geometry = known[size];
  if (geometry.direction.empty()) {
    for (std::size_t texel = 0; texel < cube::texel_count(size); ++texel) {
      geometry.direction.push_back(cube::texel_direction(texel, size));
      geometry.solid_angle.push_back(cube::texel_solid_angle(texel, size));
    }
  }
  return geometry;
}

/// ∫ L dω, as the product's integral(), but fast enough for thousands of lights.
inline Vec3d energy_of(const CubeLight& light) {
  const TexelGeometry& texels = texel_geometry(light.size);
  Vec3d sum;
  for (std::size_t texel = 0; texel < light.count(); ++texel) {
    sum += Vec3d(light.at(texel)) * texels.solid_angle[texel];
  }
  return sum;
}

/// ∫ ω L dω of a channel: the direction in which its energy lies.
inline Vec3d first_moment(const CubeLight& light, int channel) {
  const TexelGeometry& texels = texel_geometry(light.size);
  Vec3d sum;
  for (std::size_t texel = 0; texel < light.count(); ++texel) {
    const double radiance = static_cast<double>(light.channel(channel)[texel]);
    sum += texels.direction[texel] * (radiance * texels.solid_angle[texel]);
  }
  return sum;
}

/// The angle between two directions of any length, exact near zero too.
inline double angle_between(const Vec3d& a, const Vec3d& b) {
  return std::atan2(length(cross(a, b)), dot(a, b));
}

/// Σ |difference of texel energies| / Σ energy, of one channel.
inline double moved_energy(const CubeLight& a, const CubeLight& b, int channel) {
  const TexelGeometry& texels = texel_geometry(a.size);
  double moved = 0, all = 0;
  for (std::size_t texel = 0; texel < a.count(); ++texel) {
    const double before = static_cast<double>(a.channel(channel)[texel]);
    const double after = static_cast<double>(b.channel(channel)[texel]);
    const double angle = texels.solid_angle[texel];
    moved += std::abs(after - before) * angle;
    all += before * angle;
  }
  return moved / all;
}

}  // namespace rimlight
