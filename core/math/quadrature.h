#pragma once

#include <functional>
#include <vector>

#include "core/math/vec.h"

namespace rimlight {

struct QuadraturePoint {
  double position = 0;
  double weight = 0;
};

/// Gauss–Legendre points on [-1, 1]: exact for polynomials to degree 2·count − 1. Newton's method
/// on the Legendre recurrence; nodes and weights to about 1e-15.
std::vector<QuadraturePoint> gauss_legendre(int count);

/// ∫ f dω over the sphere by Gauss–Legendre in z and equal steps in φ: exact for spherical
/// harmonics to degree 2·count − 1.
double integrate_sphere(int count, const std::function<double(const Vec3d&)>& f);

}  // namespace rimlight
