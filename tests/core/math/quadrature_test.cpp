#include "core/math/quadrature.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rimlight {
namespace {

// Newton's method stops at steps of 1e-15, which move a weight by 2|x|/(1 − x²) · 1e-15 of itself:
// together −2 ln(1 − x₁²) · 1e-15, x₁ the outermost point, 6.6e-15 for 12 points; and roundings.
constexpr double kSumError = 1e-14;

double integral_of_power(int count, int power) {
  double sum = 0;
  for (const QuadraturePoint& p : gauss_legendre(count)) {
    sum += p.weight * std::pow(p.position, power);
  }
  return sum;
}

TEST(GaussLegendre, IsExactToDegreeTwoNMinusOneAndNoFurther) {
  for (int count = 1; count <= 12; ++count) {
    for (int power = 0; power <= 2 * count - 1; ++power) {
      const double exact = power % 2 == 0 ? 2.0 / (power + 1) : 0;
      EXPECT_NEAR(integral_of_power(count, power), exact, kSumError) << count << " " << power;
    }
    // The error of the next power: 2^(2n+1) n!⁴ / ((2n+1) (2n)!²).
    const double error = std::exp((2 * count + 1) * std::numbers::ln2 +
                                  4 * std::lgamma(count + 1.0) - 2 * std::lgamma(2 * count + 1.0)) /
                         (2 * count + 1);
    EXPECT_NEAR(2.0 / (2 * count + 1) - integral_of_power(count, 2 * count), error,
                1e-14 + 1e-6 * error)
        << count;
  }
}

TEST(GaussLegendre, PointsAreInsideSymmetricAndOrderedAndWeightsPositive) {
  for (const int count : {1, 2, 3, 16, 63, 64, 301}) {
    const std::vector<QuadraturePoint> points = gauss_legendre(count);
    ASSERT_EQ(points.size(), static_cast<std::size_t>(count));
    double sum = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const QuadraturePoint& mirrored = points[points.size() - 1 - i];
      EXPECT_NEAR(points[i].position, -mirrored.position, 2e-15);
      EXPECT_NEAR(points[i].weight, mirrored.weight, 1e-13);
      EXPECT_GT(points[i].weight, 0);
      EXPECT_LT(std::abs(points[i].position), 1);
      if (i > 0) {
        EXPECT_LT(points[i].position, points[i - 1].position);
      }
      sum += points[i].weight;
    }
    EXPECT_NEAR(sum, 2, 1e-12) << count;
  }
}

/// ∫ x^a y^b z^c dω (Folland 2001): 0 for an odd power, else 2 Γ(α)Γ(β)Γ(γ)/Γ(α+β+γ), α = (a+1)/2 …
double sphere_moment(int a, int b, int c) {
  if (a % 2 != 0 || b % 2 != 0 || c % 2 != 0) return 0;
  const double alpha = (a + 1) / 2.0, beta = (b + 1) / 2.0, gamma = (c + 1) / 2.0;
  return 2 * std::tgamma(alpha) * std::tgamma(beta) * std::tgamma(gamma) /
         std::tgamma(alpha + beta + gamma);
}

TEST(IntegrateSphere, IsExactForPolynomialsToDegreeTwoNMinusOne) {
  int cases = 0;
  for (int count = 1; count <= 6; ++count) {
    for (int a = 0; a <= 2 * count - 1; ++a) {
      for (int b = 0; a + b <= 2 * count - 1; ++b) {
        for (int c = 0; a + b + c <= 2 * count - 1; ++c, ++cases) {
          const double integral = integrate_sphere(count, [&](const Vec3d& d) {
            return std::pow(d.x, a) * std::pow(d.y, b) * std::pow(d.z, c);
          });
          EXPECT_NEAR(integral, sphere_moment(a, b, c), 2 * std::numbers::pi * kSumError)
              << a << " " << b << " " << c;
        }
      }
    }
  }
  EXPECT_GT(cases, 500);
}

TEST(IntegrateSphere, CallsWithUnitDirectionsAndConvergesOnAPeak) {
  // A lobe e^(k (d·m − 1)) about any m has the integral 2π (1 − e^(−2k))/k.
  const Vec3d middle = normalized(Vec3d(1, 2, -3));
  const double integral = integrate_sphere(40, [&](const Vec3d& d) {
    EXPECT_NEAR(length(d), 1, 1e-14);
    return std::exp(20 * (dot(d, middle) - 1));
  });
  EXPECT_NEAR(integral, 2 * std::numbers::pi / 20 * (1 - std::exp(-40.0)), 1e-13);
}

}  // namespace
}  // namespace rimlight
