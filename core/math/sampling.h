#pragma once

#include "core/math/random.h"
#include "core/math/vec.h"

namespace rimlight {

/// Two numbers in [0, 1).
struct Sample2 {
  double u = 0, v = 0;
};

Sample2 random_sample(Random& random);

/// Point i of the R2 sequence, shifted: shift + i · (1/ρ, 1/ρ²) modulo 1, ρ the plastic number. Any
/// number of first points covers the unit square evenly (Roberts 2018). i ≥ 0.
Sample2 r2_point(const Sample2& shift, int i);

/// A unit direction, uniform over the sphere.
Vec3d uniform_sphere(const Sample2& sample);

/// A unit direction about +z with density cos θ / π.
Vec3d cosine_hemisphere(const Sample2& sample);

/// A point of the unit disc, uniform; concentric, so that strata stay compact (Shirley and Chiu
/// 1997).
struct DiscPoint {
  double x = 0, y = 0;
};
DiscPoint uniform_disc(const Sample2& sample);

}  // namespace rimlight
