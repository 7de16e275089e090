#pragma once

#include <cmath>
#include <vector>

#include "core/basis/sh.h"
#include "core/math/random.h"
#include "core/math/sampling.h"
#include "core/math/vec.h"

namespace rimlight {

/// Poles, near-poles at every scale of float, axes, diagonals, the equator, and random directions.
inline std::vector<Vec3d> telling_directions(int random_count) {
  std::vector<Vec3d> directions;
  for (const double z : {-1.0, 1.0}) {
    directions.emplace_back(0, 0, z);
    for (double off = 0.5; off > 1e-40; off *= 0.3) {
      directions.push_back(normalized(Vec3d(off, 0, z)));
      directions.push_back(normalized(Vec3d(-0.6 * off, 0.8 * off, z)));
      directions.push_back(normalized(Vec3d(1, -1, z * off)));  // near the equator
    }
  }
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (x != 0 || y != 0 || z != 0) directions.push_back(normalized(Vec3d(x, y, z)));
      }
    }
  }
  Random random(71);
  for (int i = 0; i < random_count; ++i) {
    directions.push_back(uniform_sphere(random_sample(random)));
  }
  return directions;
}

/// Coefficients in [−1, 1].
inline std::vector<float> random_signal(int degree, Random& random) {
  std::vector<float> signal(sh::coefficient_count(degree));
  for (float& value : signal) value = static_cast<float>(random.uniform(-1, 1));
  return signal;
}

/// Σ f_lm Y_lm at a direction, in double.
template <typename T>
double value_at(const std::vector<T>& signal, const Vec3d& direction) {
  const auto basis = sh::evaluate(direction, sh::degree_of_count(signal.size()));
  double sum = 0;
  for (std::size_t i = 0; i < basis.size(); ++i) sum += static_cast<double>(signal[i]) * basis[i];
  return sum;
}

}  // namespace rimlight
