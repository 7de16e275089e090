#include "core/basis/cube_haar.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/base/check.h"
#include "core/math/quadrature.h"
#include "core/math/random.h"
#include "tests/support/reference/cube_haar_reference.h"

namespace rimlight {
namespace {

std::vector<float> random_values(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<float> values(count);
  for (float& value : values) value = static_cast<float>(random.uniform(-1, 1));
  return values;
}

std::vector<float> coefficients_of(const CubeHaar& haar, std::vector<float> texels) {
  std::vector<float> coefficients(texels.size());
  haar.forward(texels, coefficients, texels.size() / haar.coefficient_count());
  return coefficients;
}

double dot_product(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += static_cast<double>(a[i]) * b[i];
  return sum;
}

/// Rounding of a sum of 4·log2(size) operations on values of size 1, with a margin of 2.
double rounding_bound(const CubeHaar& haar) {
  constexpr double kEpsilon = std::numeric_limits<float>::epsilon();
  return 2.0 * 4 * haar.band_count() * kEpsilon * haar.size();
}

TEST(CubeHaar, EveryCoefficientIsTheFunctionThatTheOrderSays) {
  for (const int size : {2, 4, 8}) {
    const CubeHaar haar(size);
    for (std::size_t j = 0; j < haar.coefficient_count(); ++j) {
      std::vector<float> unit(haar.coefficient_count(), 0.0f), texels(unit.size());
      unit[j] = 1;
      haar.inverse(unit, texels);
      const std::vector<double> expected = reference::haar_function(j, size);
      for (std::size_t t = 0; t < texels.size(); ++t) {
        ASSERT_EQ(static_cast<double>(texels[t]), expected[t])
            << "size " << size << ", coefficient " << j << ", texel " << t;
      }
    }
  }
}

TEST(CubeHaar, BandsCoverTheCoefficientsInOrder) {
  for (const int size : {2, 8, 64, 512}) {
    const CubeHaar haar(size);
    EXPECT_EQ(haar.band_begin(0), 0u);
    EXPECT_EQ(haar.band_begin(haar.band_count()), haar.coefficient_count());
    for (int band = 0; band < haar.band_count(); ++band) {
      EXPECT_LT(haar.band_begin(band), haar.band_begin(band + 1));
      EXPECT_EQ(haar.band_of(haar.band_begin(band)), band);
      EXPECT_EQ(haar.band_of(haar.band_begin(band + 1) - 1), band);
      const double width = size / std::pow(2.0, band);
      EXPECT_EQ(haar.band_area(band), width * width);
    }
  }
}

TEST(CubeHaar, ForwardIsTheTransposeOfInverse) {
  for (const int size : {2, 4, 16, 64}) {
    const CubeHaar haar(size);
    const auto texels = random_values(haar.coefficient_count(), 1);
    const auto coefficients = random_values(haar.coefficient_count(), 2);
    std::vector<float> reconstructed(texels.size());
    haar.inverse(coefficients, reconstructed);
    EXPECT_NEAR(dot_product(coefficients_of(haar, texels), coefficients),
                dot_product(texels, reconstructed), rounding_bound(haar) * size);
  }
}

TEST(CubeHaar, InverseUndoesForward) {
  for (const int size : {2, 4, 8, 32, 128}) {
    const CubeHaar haar(size);
    const auto texels = random_values(haar.coefficient_count(), 3);
    std::vector<float> back(texels.size());
    haar.inverse(coefficients_of(haar, texels), back);
    for (std::size_t t = 0; t < texels.size(); ++t) {
      ASSERT_NEAR(back[t], texels[t], rounding_bound(haar)) << "size " << size;
    }
  }
}

TEST(CubeHaar, KeepsTheSumOfSquares) {
  for (const int size : {2, 16, 128}) {
    const CubeHaar haar(size);
    const auto texels = random_values(haar.coefficient_count(), 4);
    const auto coefficients = coefficients_of(haar, texels);
    const double squares = dot_product(texels, texels);
    EXPECT_NEAR(dot_product(coefficients, coefficients), squares, rounding_bound(haar) * squares);
  }
}

TEST(CubeHaar, ManyLanesEqualEachLaneAlone) {
  for (const std::size_t lanes : {2u, 3u, 8u, 13u, 192u}) {
    const CubeHaar haar(8);
    const std::size_t count = haar.coefficient_count();
    const auto texels = random_values(count * lanes, 5);
    const auto together = coefficients_of(haar, texels);
    std::vector<float> back(texels.size());
    haar.inverse(together, back, lanes);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      std::vector<float> alone(count), alone_back(count);
      for (std::size_t i = 0; i < count; ++i) alone[i] = texels[i * lanes + lane];
      const auto coefficients = coefficients_of(haar, alone);
      haar.inverse(coefficients, alone_back);
      for (std::size_t i = 0; i < count; ++i) {
        ASSERT_EQ(together[i * lanes + lane], coefficients[i]) << lanes << " lanes";
        ASSERT_EQ(back[i * lanes + lane], alone_back[i]) << lanes << " lanes";
      }
    }
  }
}

TEST(CubeHaar, AUniformLightIsOneCoefficientAFace) {
  const CubeHaar haar(64);
  const auto coefficients = coefficients_of(haar, std::vector<float>(haar.coefficient_count(), 2));
  for (std::size_t j = 0; j < coefficients.size(); ++j) {
    const bool scaling = j < 24 && j % 4 == 0;
    ASSERT_EQ(coefficients[j], scaling ? 128.0f : 0.0f) << j;
  }
}

// ---- A dot product of coefficients is the integral of light times transport over the sphere.

constexpr int kTexelPoints = 6;  // Gauss–Legendre points a side: exact to degree 11 in a texel

/// ∫ f dω over one texel, in double.
template <typename F>
double texel_integral(std::size_t texel, int size, const F& f) {
  static const std::vector<QuadraturePoint> points = gauss_legendre(kTexelPoints);
  const int index = static_cast<int>(texel);
  const int face = index / (size * size), row = index / size % size, column = index % size;
  double sum = 0;
  for (const QuadraturePoint& py : points) {
    for (const QuadraturePoint& px : points) {
      const double x = (2 * column + 1 + px.position) / size - 1;
      const double y = (2 * row + 1 + py.position) / size - 1;
      const double q = 1 + x * x + y * y;
      sum += px.weight * py.weight * f(cube::direction({face, x, y})) / (q * std::sqrt(q));
    }
  }
  return sum / (static_cast<double>(size) * size);
}

/// Smooth, of both parities, and unsymmetrical in all axes.
double smooth_light(const Vec3d& d) { return std::exp(0.7 * d.x - 0.4 * d.y) + d.z * d.x + 0.5; }
double smooth_transport(const Vec3d& d) { return std::exp(0.9 * d.z + 0.5 * d.x) - 0.3 * d.y; }

/// Σ_j (H L)_j (H M)_j with the basis' convention for solid angle.
template <typename Light, typename Transport>
double coefficient_product(int size, const Light& light, const Transport& transport) {
  const CubeHaar haar(size);
  std::vector<float> mean(haar.coefficient_count()), integral(mean.size());
  for (std::size_t t = 0; t < mean.size(); ++t) {
    mean[t] = static_cast<float>(texel_integral(t, size, light) / cube::texel_solid_angle(t, size));
    integral[t] = static_cast<float>(texel_integral(t, size, transport));
  }
  return dot_product(coefficients_of(haar, mean), coefficients_of(haar, integral));
}

TEST(CubeHaar, AProductOfCoefficientsConvergesToTheIntegralAtTheSquareOfTheTexel) {
  const double truth =
      integrate_sphere(40, [](const Vec3d& d) { return smooth_light(d) * smooth_transport(d); });
  std::vector<double> errors;
  for (const int size : {4, 8, 16, 32}) {
    errors.push_back(std::abs(coefficient_product(size, smooth_light, smooth_transport) - truth) /
                     truth);
    RecordProperty("error_" + std::to_string(size), std::to_string(errors.back()));
  }
  // What light and transport vary together inside a texel falls with its area: 4 at each doubling.
  for (std::size_t i = 1; i < errors.size(); ++i) {
    EXPECT_NEAR(errors[i - 1] / errors[i], 4, 0.4) << "from doubling " << i;
  }
  EXPECT_LT(errors.back(), 1e-3);
}

TEST(CubeHaar, AProductOfCoefficientsIsTheIntegralWhenTheLightIsConstantInEachTexel) {
  const int size = 16;
  const auto values = random_values(cube::texel_count(size), 6);
  const auto light = [&](const Vec3d& d) {
    return 2.0 + static_cast<double>(values[cube::texel_of(d, size)]);
  };
  double truth = 0;  // texel by texel, with the truth's own finer quadrature: 4 × 4 parts each
  const int fine = 4 * size;
  for (std::size_t t = 0; t < cube::texel_count(fine); ++t) {
    truth +=
        texel_integral(t, fine, [&](const Vec3d& d) { return light(d) * smooth_transport(d); });
  }
  // float rounding of 1,536 products, each to a few ulp and random in sign
  EXPECT_NEAR(coefficient_product(size, light, smooth_transport) / truth, 1, 1e-6);
}

TEST(CubeHaar, RefusesSizesThatAreNoPowerOfTwo) {
  for (const int size : {-4, 0, 1, 3, 12, 1024}) EXPECT_THROW(CubeHaar{size}, CheckFailure) << size;
  const CubeHaar haar(4);
  std::vector<float> right(96), wrong(95);
  EXPECT_THROW(haar.forward(wrong, right), CheckFailure);
  EXPECT_THROW(haar.inverse(right, wrong), CheckFailure);
}

}  // namespace
}  // namespace rimlight
