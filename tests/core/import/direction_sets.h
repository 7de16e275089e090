#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "core/basis/cube_map.h"
#include "core/math/random.h"
#include "core/math/sampling.h"

namespace rimlight {

/// Sets of unit directions for tests.

inline std::vector<Vec3d> random_directions(int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3d> directions;
  for (int i = 0; i < count; ++i) directions.push_back(uniform_sphere(random_sample(random)));
  return directions;
}

/// Those of uniformly random directions that lie within the angle of an axis.
inline std::vector<Vec3d> random_cap(int count, const Vec3d& axis, double angle,
                                     std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3d> directions;
  while (static_cast<int>(directions.size()) < count) {
    const Vec3d one = uniform_sphere(random_sample(random));
    if (dot(one, axis) > std::cos(angle)) directions.push_back(one);
  }
  return directions;
}

inline std::vector<Vec3d> texel_directions(int size) {
  std::vector<Vec3d> directions;
  for (std::size_t texel = 0; texel < cube::texel_count(size); ++texel) {
    directions.push_back(cube::texel_direction(texel, size));
  }
  return directions;
}

/// The middles of a grid of latitudes and longitudes.
inline std::vector<Vec3d> grid_directions(int rows, int columns) {
  std::vector<Vec3d> directions;
  for (int row = 0; row < rows; ++row) {
    const double theta = (row + 0.5) * std::numbers::pi / rows;
    for (int column = 0; column < columns; ++column) {
      const double phi = (column + 0.5) * 2 * std::numbers::pi / columns;
      directions.emplace_back(std::sin(theta) * std::sin(phi), std::cos(theta),
                              -std::sin(theta) * std::cos(phi));
    }
  }
  return directions;
}

}  // namespace rimlight
