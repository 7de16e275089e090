#include "core/basis/sh_product_matrix.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/check.h"
#include "core/basis/sh_product.h"
#include "tests/core/basis/sh_product_cases.h"
#include "tests/support/every_target.h"

namespace rimlight {
namespace {

using sh::coefficient_count;
constexpr std::size_t kChannels = ShProductMatrix::kChannels;

std::vector<float> random_light(int degree, std::uint64_t seed) {
  std::vector<float> light;
  for (std::size_t c = 0; c < kChannels; ++c) {
    const auto channel = test::random_coefficients(degree, seed + c);
    light.insert(light.end(), channel.begin(), channel.end());
  }
  return light;
}

std::span<const float> channel_of(std::span<const float> light, std::size_t channel) {
  const std::size_t size = light.size() / kChannels;
  return light.subspan(channel * size, size);
}

double norm(std::span<const float> values) {
  double sum = 0;
  for (const float value : values) sum += static_cast<double>(value) * value;
  return std::sqrt(sum);
}

/// As the header says: what each entry may be off by.
double entry_bound(std::span<const float> light) { return 0x1p-24 * norm(light); }

/// M · f in double, of the entries as they are.
std::vector<double> times(const ShProductMatrix& matrix, std::size_t channel,
                          std::span<const float> f) {
  std::vector<double> product(matrix.size());
  for (std::size_t i = 0; i < product.size(); ++i) {
    for (std::size_t j = 0; j < f.size(); ++j) {
      product[i] += static_cast<double>(matrix.row(channel, i)[j]) * f[j];
    }
  }
  return product;
}

double largest_difference(const ShProductMatrix& a, const ShProductMatrix& b) {
  double worst = 0;
  for (std::size_t c = 0; c < kChannels; ++c) {
    for (std::size_t i = 0; i < a.size(); ++i) {
      for (std::size_t j = 0; j < a.stride(); ++j) {
        const double difference = std::abs(a.row(c, i)[j] - b.row(c, i)[j]);
        if (!(difference <= worst)) worst = difference;
      }
    }
  }
  return worst;
}

TEST(ShProductMatrix, EveryEntryIsTheSumOfTriplingCoefficientsUnderEveryTarget) {
  for (const int degree : {0, 1, 2, 5, 10, 13}) {
    const std::size_t size = coefficient_count(degree);
    const auto light = random_light(2 * degree, 1);
    std::vector<double> expected(kChannels * size * size);
    for (std::size_t c = 0; c < kChannels; ++c) {
      const auto channel = channel_of(light, c);
      ShTripling::to_degree(degree).for_each(
          [&](std::size_t i, std::size_t j, std::size_t k, float value) {
            expected[(c * size + i) * size + j] += static_cast<double>(value) * channel[k];
          });
    }
    const int targets = test::for_every_target([&] {
      ShProductMatrix matrix(degree);
      matrix.set_light(light);
      for (std::size_t c = 0; c < kChannels; ++c) {
        for (std::size_t i = 0; i < size; ++i) {
          for (std::size_t j = 0; j <= i; ++j) {
            ASSERT_NEAR(matrix.row(c, i)[j], expected[(c * size + i) * size + j],
                        entry_bound(channel_of(light, c)))
                << degree << ": " << c << " " << i << " " << j;
          }
        }
      }
    });
    EXPECT_GT(targets, 0);
  }
}

TEST(ShProductMatrix, TimesTransportIsTheBruteForceProduct) {
  for (const int degree : {0, 1, 4, 9}) {
    const auto light = random_light(2 * degree, 2);
    const auto transport = test::random_coefficients(degree, 3);
    ShProductMatrix matrix(degree);
    matrix.set_light(light);
    for (std::size_t c = 0; c < kChannels; ++c) {
      const auto channel = channel_of(light, c);
      const auto expected = test::brute_force_product<float>(channel, transport, degree);
      const auto product = times(matrix, c, transport);
      for (std::size_t i = 0; i < product.size(); ++i) {
        ASSERT_NEAR(product[i], expected[i], (degree + 1) * entry_bound(channel) * norm(transport));
      }
    }
  }
}

TEST(ShProductMatrix, TimesTransportIsTheProductProjectionToTheLargestDegree) {
  for (const int degree : {3, 10, sh::kLargestDegree}) {
    const auto light = random_light(2 * degree, 4);
    const auto transport = test::random_coefficients(degree, 5);
    ShProductMatrix matrix(degree);
    matrix.set_light(light);
    for (std::size_t c = 0; c < kChannels; ++c) {
      const auto channel = channel_of(light, c);
      const auto expected = ShProduct({2 * degree, degree, degree}).multiply(channel, transport);
      const auto product = times(matrix, c, transport);
      for (std::size_t i = 0; i < product.size(); ++i) {
        ASSERT_NEAR(product[i], expected[i], (degree + 1) * entry_bound(channel) * norm(transport));
      }
    }
  }
}

TEST(ShProductMatrix, IsSymmetricBitForBitAndPaddedWithZeros) {
  for (const int degree : {1, 6, 10}) {
    ShProductMatrix matrix(degree);
    matrix.set_light(random_light(2 * degree, 6));
    for (std::size_t c = 0; c < kChannels; ++c) {
      for (std::size_t i = 0; i < matrix.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) ASSERT_EQ(matrix.row(c, i)[j], matrix.row(c, j)[i]);
        for (std::size_t j = matrix.size(); j < matrix.stride(); ++j) {
          ASSERT_EQ(matrix.row(c, i)[j], 0);
        }
      }
    }
  }
}

TEST(ShProductMatrix, OfAUniformLightIsItsRadianceTimesTheIdentity) {
  for (const int degree : {0, 7, sh::kLargestDegree}) {
    const auto unit = static_cast<float>(std::sqrt(4 * std::numbers::pi));
    ShProductMatrix matrix(degree);
    matrix.set_light(std::vector<float>{unit, 2 * unit, 0});
    for (std::size_t c = 0; c < kChannels; ++c) {
      const double radiance = c == 0 ? 1 : c == 1 ? 2 : 0;
      for (std::size_t i = 0; i < matrix.size(); ++i) {
        for (std::size_t j = 0; j < matrix.size(); ++j) {
          ASSERT_NEAR(matrix.row(c, i)[j], i == j ? radiance : 0, 1e-6);
        }
      }
    }
  }
}

double least_eigenvalue(const ShProductMatrix& matrix, std::size_t channel) {
  const auto size = static_cast<Eigen::Index>(matrix.size());
  Eigen::MatrixXd values(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < size; ++j) {
      values(i, j) = matrix.row(channel, static_cast<std::size_t>(i))[j];
    }
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(values, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .minCoeff();
}

// A few suns: the coefficients of ∑ w δ(ω − ω_s) are Σ w Y(ω_s), and M is Σ w Y Yᵀ to degree n.
std::vector<float> light_of_suns(int degree) {
  Random random(7);
  std::vector<float> light(kChannels * coefficient_count(degree));
  for (int sun = 0; sun < 5; ++sun) {
    const double z = random.uniform(-1, 1), phi = random.uniform(0, 2 * std::numbers::pi);
    const double r = std::sqrt(1 - z * z);
    const auto y = test::harmonics_at(degree, {r * std::cos(phi), r * std::sin(phi), z});
    for (std::size_t c = 0; c < kChannels; ++c) {
      const double weight = random.uniform();
      for (std::size_t i = 0; i < y.size(); ++i) {
        light[c * y.size() + i] += static_cast<float>(weight * y[i]);
      }
    }
  }
  return light;
}

TEST(ShProductMatrix, OfALightWithoutNegativeRadianceIsPositiveSemidefiniteUnlessItIsCutOff) {
  constexpr int kDegree = 6;
  const auto light = light_of_suns(2 * kDegree);
  ShProductMatrix exact(kDegree), cut(kDegree);
  exact.set_light(light);
  cut.set_light(light, {0, kDegree});
  for (std::size_t c = 0; c < kChannels; ++c) {
    // ‖error of M‖ ≤ size · error of an entry.
    const double bound = static_cast<double>(exact.size()) * entry_bound(channel_of(light, c));
    EXPECT_GE(least_eigenvalue(exact, c), -bound);
    EXPECT_LT(least_eigenvalue(cut, c), -100 * bound);
  }
}

TEST(ShProductMatrix, SeesOfALightWhatIsAskedForAndNoMoreThanTwiceItsDegree) {
  constexpr int kDegree = 4;
  const auto light = random_light(3 * kDegree, 8);
  const auto cut_light = [&](int degree) {
    std::vector<float> cut;
    for (std::size_t c = 0; c < kChannels; ++c) {
      const auto channel = channel_of(light, c).first(coefficient_count(degree));
      cut.insert(cut.end(), channel.begin(), channel.end());
    }
    return cut;
  };
  ShProductMatrix matrix(kDegree), other(kDegree);
  matrix.set_light(light);
  other.set_light(cut_light(2 * kDegree));
  EXPECT_EQ(largest_difference(matrix, other), 0) << "degrees above 2n";
  matrix.set_light(light, {0, kDegree});
  EXPECT_GT(largest_difference(matrix, other), 0.01);
  other.set_light(cut_light(kDegree));
  EXPECT_EQ(largest_difference(matrix, other), 0) << "what was there before is gone";
}

TEST(ShProductMatrix, TheIncrementsOfALightsDegreesAddUpToTheWhole) {
  for (const int degree : {0, 1, 5, 10}) {
    const auto light = random_light(2 * degree, 9);
    ShProductMatrix whole(degree), sum(degree);
    whole.set_light(light);
    double least_increment = degree == 0 ? 0 : INFINITY;
    for (int l = 0; l <= 2 * degree; ++l) {
      const ShProductMatrix before = sum;
      sum.add_light(light, {l, l});
      least_increment = std::min(least_increment, largest_difference(before, sum));
      ShProductMatrix prefix(degree);
      prefix.set_light(light, {0, l});
      ASSERT_LE(largest_difference(prefix, sum), entry_bound(light)) << degree << " " << l;
    }
    EXPECT_TRUE(degree == 0 || least_increment > 0.01) << "each degree counts";
    EXPECT_LE(largest_difference(whole, sum), entry_bound(light));
  }
}

TEST(ShProductMatrix, AddingALightMakesTheMatrixOfTheSum) {
  constexpr int kDegree = 7;
  const auto first = random_light(2 * kDegree, 10), second = random_light(kDegree, 20);
  std::vector<float> both = first;
  for (std::size_t c = 0; c < kChannels; ++c) {
    for (std::size_t i = 0; i < coefficient_count(kDegree); ++i) {
      both[c * coefficient_count(2 * kDegree) + i] += channel_of(second, c)[i];
    }
  }
  ShProductMatrix sum(kDegree), expected(kDegree);
  sum.set_light(first);
  sum.add_light(second);
  expected.set_light(both);
  EXPECT_LE(largest_difference(sum, expected), entry_bound(both));
}

TEST(ShProductMatrix, RefusesDegreesAndSizesOutOfRange) {
  EXPECT_THROW(ShProductMatrix(-1), CheckFailure);
  EXPECT_THROW(ShProductMatrix(sh::kLargestDegree + 1), CheckFailure);
  ShProductMatrix matrix(2);
  const auto light = random_light(4, 11);
  EXPECT_THROW(matrix.set_light(std::span(light).first(74)), CheckFailure);
  EXPECT_THROW(matrix.set_light({}), CheckFailure);
  EXPECT_THROW(matrix.set_light(random_light(sh::kLargestLightDegree + 1, 1)), CheckFailure);
  EXPECT_THROW(matrix.set_light(light, {-1, 2}), CheckFailure);
  EXPECT_THROW(matrix.set_light(light, {3, 2}), CheckFailure);
  matrix.set_light(light, {9, 9});  // beyond what the matrix sees: nothing
  EXPECT_EQ(largest_difference(matrix, ShProductMatrix(2)), 0);
}

}  // namespace
}  // namespace rimlight
