#include "core/math/quadrature.h"

#include <cmath>
#include <numbers>

namespace rimlight {

std::vector<QuadraturePoint> gauss_legendre(int count) {
  std::vector<QuadraturePoint> points(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (count + 0.5));
    double derivative = 1;
    for (int step = 0; step < 100; ++step) {
      double previous = 1;
      double value = x;
      for (int degree = 2; degree <= count; ++degree) {
        const double next = ((2 * degree - 1) * x * value - (degree - 1) * previous) / degree;
        previous = value;
        value = next;
      }
      if (count == 1) previous = 1;
      derivative = count * (x * value - previous) / (x * x - 1);
      const double change = value / derivative;
      x -= change;
      if (std::abs(change) < 1e-15) break;
    }
    points[static_cast<std::size_t>(i)] = {x, 2 / ((1 - x * x) * derivative * derivative)};
  }
  return points;
}

double integrate_sphere(int count, const std::function<double(const Vec3d&)>& f) {
  double sum = 0;
  const int turns = 2 * count;
  for (const QuadraturePoint& point : gauss_legendre(count)) {
    const double r = std::sqrt(1 - point.position * point.position);
    for (int i = 0; i < turns; ++i) {
      const double phi = 2 * std::numbers::pi * (i + 0.5) / turns;
      sum += point.weight * 2 * std::numbers::pi / turns *
             f({r * std::cos(phi), r * std::sin(phi), point.position});
    }
  }
  return sum;
}

}  // namespace rimlight
