#include "core/basis/sh_product.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/base/check.h"
#include "tests/core/basis/sh_product_cases.h"
#include "tests/support/every_target.h"

namespace rimlight {
namespace {

using sh::coefficient_count;
constexpr std::size_t kLanes = ShProduct::kLaneMultiple;

double norm(std::span<const float> values) {
  double sum = 0;
  for (const float value : values) sum += static_cast<double>(value) * value;
  return std::sqrt(sum);
}

/// The largest difference over ‖f‖ ‖g‖.
double relative_error(std::span<const float> product, std::span<const double> expected,
                      std::span<const float> f, std::span<const float> g) {
  EXPECT_EQ(product.size(), expected.size());
  double worst = 0;
  for (std::size_t i = 0; i < product.size(); ++i) {
    // Written so that NaN is the worst.
    const double error = std::abs(product[i] - expected[i]);
    if (!(error <= worst)) worst = error;
  }
  return worst / (norm(f) * norm(g));
}

// Each of a function's values on the grid is a sum of (n + 1)² terms, done in two stages of 2n + 1
// roundings at most, and so is each coefficient of the product. By Cauchy–Schwarz a value is at
// most ‖f‖ (n + 1) / √4π, so a product's error is below (number of roundings) · ε · (n + 1)² / 4π ·
// √4π of ‖f‖ ‖g‖; roundings add up like a random walk, which earns a root, and most values are
// smaller.
double error_bound(int degree) {
  const double roundings = std::sqrt(6.0 * (2 * degree + 1) + 8);
  return roundings * 0x1p-24 * (degree + 1) * (degree + 1) / std::sqrt(4 * std::numbers::pi);
}

TEST(ShProduct, IsTheBruteForceProductUnderEveryTarget) {
  const ShProduct::Degrees cases[] = {{0, 0, 0}, {1, 0, 1}, {0, 3, 2},    {2, 2, 4},    {5, 3, 6},
                                      {4, 7, 0}, {9, 9, 9}, {10, 20, 10}, {13, 13, 13}, {3, 3, 9}};
  double worst = 0;
  for (const ShProduct::Degrees& degrees : cases) {
    const auto f = test::random_coefficients(degrees.first, 1);
    const auto g = test::random_coefficients(degrees.second, 2);
    const auto expected = test::brute_force_product<float>(f, g, degrees.product);
    const double bound = error_bound(std::max({degrees.first, degrees.second, degrees.product}));
    const int targets = test::for_every_target([&] {
      const double error =
          relative_error(ShProduct(degrees).multiply(f, g), expected, f, g) / bound;
      EXPECT_LE(error, 1) << degrees.first << " " << degrees.second << " " << degrees.product;
      worst = std::max(worst, error);
    });
    EXPECT_GT(targets, 0);
  }
  RecordProperty("worst_of_bound", std::to_string(worst));
}

TEST(ShProduct, IsTheSumOverTheTriplingCoefficients) {
  for (const int degree : {1, 6, 10, sh::kLargestDegree}) {
    const auto f = test::random_coefficients(degree, 3);
    const auto g = test::random_coefficients(degree, 4);
    std::vector<double> expected(coefficient_count(2 * degree));
    ShTripling::to_degree(degree).for_each(
        [&](std::size_t i, std::size_t j, std::size_t k, float value) {
          const double pair = static_cast<double>(f[i]) * g[j];
          expected[k] += value * (i == j ? pair : pair + static_cast<double>(f[j]) * g[i]);
        });
    const auto whole = ShProduct({degree, degree, 2 * degree}).multiply(f, g);
    EXPECT_LE(relative_error(whole, expected, f, g), error_bound(2 * degree)) << degree;
    expected.resize(coefficient_count(degree));
    const auto cut = ShProduct({degree, degree, degree}).multiply(f, g);
    EXPECT_LE(relative_error(cut, expected, f, g), error_bound(degree)) << degree;
  }
}

TEST(ShProduct, IsAsAccurateAsItsHeaderSaysAtDegreeTen) {
  // Rough functions, and the sharpest peak that a degree can have.
  std::vector<std::vector<float>> functions;
  for (std::uint64_t seed = 10; seed < 14; ++seed) {
    functions.push_back(test::random_coefficients(10, seed));
  }
  const auto peak = test::harmonics_at(10, {0.48, -0.6, 0.64});
  functions.emplace_back(peak.begin(), peak.end());
  const ShProduct product({10, 10, 10});
  for (const auto& f : functions) {
    for (const auto& g : functions) {
      const auto expected = test::brute_force_product<float>(f, g, 10);
      EXPECT_LE(relative_error(product.multiply(f, g), expected, f, g), 1e-7);
    }
  }
}

TEST(ShProduct, TheConstantOneLeavesTheOtherAsItIs) {
  for (const int degree : {0, 1, 10, 32, sh::kLargestLightDegree}) {
    const auto f = test::random_coefficients(degree, 5);
    const std::vector<float> one = {static_cast<float>(std::sqrt(4 * std::numbers::pi))};
    const std::vector<double> expected(f.begin(), f.end());
    EXPECT_LE(relative_error(ShProduct({degree, 0, degree}).multiply(f, one), expected, f, one),
              error_bound(degree));
    EXPECT_LE(relative_error(ShProduct({0, degree, degree}).multiply(one, f), expected, one, f),
              error_bound(degree));
  }
}

TEST(ShProduct, TheFactorsCanBeExchanged) {
  const auto f = test::random_coefficients(8, 6);
  const auto g = test::random_coefficients(5, 7);
  const auto one_way = ShProduct({8, 5, 9}).multiply(f, g);
  const auto other = ShProduct({5, 8, 9}).multiply(g, f);
  const std::vector<double> expected(other.begin(), other.end());
  EXPECT_LE(relative_error(one_way, expected, f, g), error_bound(9));
}

TEST(ShProduct, IsLinearInEachFactor) {
  const auto f = test::random_coefficients(7, 8);
  const auto g = test::random_coefficients(7, 9), other = test::random_coefficients(7, 10);
  std::vector<float> sum(g.size());
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = g[i] - 4 * other[i];
  const ShProduct product({7, 7, 7});
  const auto first = product.multiply(f, g), second = product.multiply(f, other);
  std::vector<double> expected(first.size());
  for (std::size_t i = 0; i < expected.size(); ++i) expected[i] = first[i] - 4.0 * second[i];
  EXPECT_LE(relative_error(product.multiply(f, sum), expected, f, sum), 3 * error_bound(7));
}

std::vector<float> random_lanes(int degree, std::size_t lanes, std::uint64_t seed) {
  Random random(seed);
  std::vector<float> values(coefficient_count(degree) * lanes);
  for (float& value : values) value = static_cast<float>(random.uniform(-1, 1));
  return values;
}

std::vector<float> lane_of(std::span<const float> values, std::size_t lanes, std::size_t lane) {
  std::vector<float> one;
  for (std::size_t i = lane; i < values.size(); i += lanes) one.push_back(values[i]);
  return one;
}

TEST(ShProduct, AReceiverGetsTheSameBitsAloneAndAmongOthers) {
  constexpr std::size_t kMany = 5 * kLanes;
  const ShProduct product({6, 4, 5});
  const auto f = random_lanes(6, kMany, 11), g = random_lanes(4, kMany, 12);
  const int targets = test::for_every_target([&] {
    std::vector<float> h(coefficient_count(5) * kMany);
    ShProduct::Workspace workspace;
    product.multiply(f, g, h, kMany, workspace);
    for (std::size_t lane = 0; lane < kMany; ++lane) {
      ASSERT_EQ(lane_of(h, kMany, lane),
                product.multiply(lane_of(f, kMany, lane), lane_of(g, kMany, lane)))
          << lane;
    }
  });
  EXPECT_GT(targets, 0);
}

TEST(ShProduct, ABadReceiverSpoilsNoOther) {
  const ShProduct product({3, 3, 3});
  auto f = random_lanes(3, kLanes, 13);
  const auto g = random_lanes(3, kLanes, 14);
  std::vector<float> clean(f.size()), spoiled(f.size());
  ShProduct::Workspace workspace;
  product.multiply(f, g, clean, kLanes, workspace);
  f[2] = std::numeric_limits<float>::quiet_NaN();
  product.multiply(f, g, spoiled, kLanes, workspace);
  for (std::size_t i = 0; i < clean.size(); ++i) {
    if (i % kLanes == 2) {
      EXPECT_TRUE(std::isnan(spoiled[i]));
    } else {
      EXPECT_EQ(spoiled[i], clean[i]);
    }
  }
}

TEST(ShProduct, CanBeWrittenOverAFactorWithAWorkspaceThatOthersUsed) {
  ShProduct::Workspace workspace;
  auto f = random_lanes(4, 2 * kLanes, 15);
  const auto g = random_lanes(4, 2 * kLanes, 16);
  std::vector<float> expected(f.size());
  ShProduct({4, 4, 4}).multiply(f, g, expected, 2 * kLanes, workspace);
  std::vector<float> large(coefficient_count(9) * kLanes);
  ShProduct({9, 9, 9}).multiply(random_lanes(9, kLanes, 1), random_lanes(9, kLanes, 2), large,
                                kLanes, workspace);
  ShProduct({4, 4, 4}).multiply(f, g, f, 2 * kLanes, workspace);
  EXPECT_EQ(f, expected);
}

TEST(ShProduct, RefusesDegreesAndSizesOutOfRange) {
  constexpr int kMost = sh::kLargestLightDegree;
  EXPECT_THROW(ShProduct({-1, 0, 0}), CheckFailure);
  EXPECT_THROW(ShProduct({0, kMost + 1, 0}), CheckFailure);
  EXPECT_THROW(ShProduct({0, 0, kMost + 1}), CheckFailure);
  const ShProduct product({1, 1, 1});
  std::vector<float> right(4 * kLanes), wrong(4 * kLanes + 1), odd(4 * 8);
  ShProduct::Workspace workspace;
  EXPECT_THROW(product.multiply(wrong, right, right, kLanes, workspace), CheckFailure);
  EXPECT_THROW(product.multiply(right, wrong, right, kLanes, workspace), CheckFailure);
  EXPECT_THROW(product.multiply(right, right, wrong, kLanes, workspace), CheckFailure);
  EXPECT_THROW(product.multiply(odd, odd, odd, 8, workspace), CheckFailure);
  EXPECT_THROW(product.multiply(wrong, right), CheckFailure);
  product.multiply({}, {}, {}, 0, workspace);  // nothing for no one
}

}  // namespace
}  // namespace rimlight
