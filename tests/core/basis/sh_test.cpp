#include "core/basis/sh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <numbers>

#include "core/base/check.h"
#include "core/math/quadrature.h"
#include "tests/core/basis/sh_cases.h"
#include "tests/support/reference/spherical_harmonics.h"

namespace rimlight {
namespace {

TEST(Sh, IndexCountsBandByBandFromMinusLToL) {
  std::size_t next = 0;
  for (int l = 0; l <= sh::kLargestLightDegree; ++l) {
    for (int m = -l; m <= l; ++m, ++next) {
      ASSERT_EQ(sh::index(l, m), next);
      ASSERT_EQ(sh::degree_of(next), l);
    }
    EXPECT_EQ(sh::coefficient_count(l), next);
    EXPECT_EQ(sh::degree_of_count(next), l);
  }
  EXPECT_EQ(next, 65u * 65u);
}

TEST(Sh, TheFirstBandsAreTheConventionsPolynomials) {
  const Vec3d d = normalized(Vec3d(0.3, -0.5, 0.7));
  const std::vector<double> values = sh::evaluate(d, 2);
  const double pi = std::numbers::pi;
  const double s = std::sqrt(3 / (4 * pi)), t = std::sqrt(15 / (4 * pi));
  const double expected[] = {std::sqrt(1 / (4 * pi)),
                             s * d.y,
                             s * d.z,
                             s * d.x,
                             t * d.x * d.y,
                             t * d.y * d.z,
                             std::sqrt(5 / (16 * pi)) * (3 * d.z * d.z - 1),
                             t * d.x * d.z,
                             t / 2 * (d.x * d.x - d.y * d.y)};
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(values[i], expected[i], 1e-15) << i;
}

TEST(Sh, EqualsTheDefinitionInAnglesAtPolesAndEverywhere) {
  // z is rounded three times, and 2⁻⁵³ of it move Y_l0 by l(l + 1)/2 · √((2l + 1)/4π) · 2⁻⁵³: by
  // 1.3e-13 at degree 32, 7.4e-13 at 64.
  for (const auto& [degree, bound] :
       {std::pair{sh::kLargestDegree, 4e-13}, {sh::kLargestLightDegree, 2.5e-12}}) {
    double worst = 0;
    for (const Vec3d& direction : telling_directions(200)) {
      const auto values = sh::evaluate(direction, degree);
      const auto truth = reference::spherical_harmonics(direction, degree);
      for (std::size_t i = 0; i < truth.size(); ++i) {
        ASSERT_TRUE(std::isfinite(values[i]));
        worst = std::max(worst, std::abs(values[i] - truth[i]));
      }
    }
    std::cout << "degree " << degree << ": worst error " << worst << "\n";
    EXPECT_LE(worst, bound);
  }
}

TEST(Sh, TheLengthOfADirectionDoesNotMatter) {
  const Vec3d direction(0.36, -0.48, 0.8);
  const auto unit = sh::evaluate(direction, 20);
  for (const double length : {1e-100, 1e-3, 0.999, 7.0, 1e100}) {
    const auto values = sh::evaluate(direction * length, 20);
    for (std::size_t i = 0; i < unit.size(); ++i) EXPECT_NEAR(values[i], unit[i], 1e-13) << length;
  }
}

TEST(Sh, IsOrthonormal) {
  constexpr int kDegree = 8;
  const std::size_t count = sh::coefficient_count(kDegree);
  std::vector<double> gram(count * count, 0.0);
  // Products are of degree 16: 9 rows of points are exact.
  const auto points = gauss_legendre(kDegree + 1);
  const int turns = 2 * kDegree + 1;
  for (const QuadraturePoint& p : points) {
    const double r = std::sqrt(1 - p.position * p.position);
    for (int i = 0; i < turns; ++i) {
      const double phi = 2 * std::numbers::pi * (i + 0.3) / turns;
      const auto y = sh::evaluate({r * std::cos(phi), r * std::sin(phi), p.position}, kDegree);
      const double weight = p.weight * 2 * std::numbers::pi / turns;
      for (std::size_t a = 0; a < count; ++a) {
        for (std::size_t b = 0; b < count; ++b) gram[a * count + b] += weight * y[a] * y[b];
      }
    }
  }
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = 0; b < count; ++b) {
      EXPECT_NEAR(gram[a * count + b], a == b ? 1 : 0, 1e-13) << a << " " << b;
    }
  }
}

TEST(Sh, TheAdditionTheoremHoldsForEachBand) {
  // Σ_m Y_lm(a) Y_lm(b) = (2l + 1)/4π · P_l(a·b) (Unsöld 1927 for a = b)
  const auto directions = telling_directions(20);
  const Vec3d b = normalized(Vec3d(-3, 1, 2));
  const auto at_b = sh::evaluate(b, sh::kLargestDegree);
  for (const Vec3d& a : directions) {
    const auto at_a = sh::evaluate(a, sh::kLargestDegree);
    const auto p = sh::legendre(dot(a, b), sh::kLargestDegree);
    for (int l = 0; l <= sh::kLargestDegree; ++l) {
      double sum = 0, square = 0;
      for (int m = -l; m <= l; ++m) {
        sum += at_a[sh::index(l, m)] * at_b[sh::index(l, m)];
        square += at_a[sh::index(l, m)] * at_a[sh::index(l, m)];
      }
      const double scale = (2 * l + 1) / (4 * std::numbers::pi);
      EXPECT_NEAR(sum, scale * p[static_cast<std::size_t>(l)], 1e-12);
      EXPECT_NEAR(square, scale, 1e-12);
    }
  }
}

TEST(Sh, LegendreEqualsTheStandardLibrary) {
  for (double z = -1; z <= 1; z += 1.0 / 64) {
    const auto values = sh::legendre(z, sh::kLargestDegree);
    ASSERT_EQ(values.size(), 33u);
    for (unsigned l = 0; l < values.size(); ++l) {
      EXPECT_NEAR(values[l], static_cast<double>(std::legendre(l, static_cast<long double>(z))),
                  2e-14);
    }
  }
}

TEST(Sh, BandEnergiesSumSquares) {
  const std::vector<float> signal = {3, 1, 2, 2, 0, 0, 0, 0, 5};
  EXPECT_EQ(sh::band_energies(signal), (std::vector<double>{9, 9, 25}));
}

TEST(Sh, RefusesShapesAndDegreesOutOfRange) {
  std::vector<double> values(9);
  EXPECT_THROW(sh::evaluate({0, 0, 1}, -1), CheckFailure);
  EXPECT_THROW(sh::evaluate({0, 0, 1}, sh::kLargestLightDegree + 1), CheckFailure);
  EXPECT_THROW(sh::evaluate({0, 0, 1}, 3, values), CheckFailure);
  EXPECT_THROW(sh::legendre(0, sh::kLargestLightDegree + 1), CheckFailure);
  EXPECT_THROW(sh::degree_of_count(0), CheckFailure);
  EXPECT_THROW(sh::degree_of_count(10), CheckFailure);
  EXPECT_THROW(sh::degree_of_count(66 * 66), CheckFailure);
}

}  // namespace
}  // namespace rimlight
