#include "core/basis/sh_tripling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <thread>
#include <tuple>
#include <vector>

#include "core/base/check.h"
#include "tests/core/basis/sh_product_cases.h"

namespace rimlight {
namespace {

using sh::coefficient_count;
using sh::index;

// Each C is rounded to float; it is at most 1 to these degrees, and sums in double add nothing.
constexpr double kRounding = 0x1p-23;

/// C(i, j, k) with i ≥ j; what is not in it is 0.
std::map<std::tuple<std::size_t, std::size_t, std::size_t>, double> all_of(
    const ShTripling& table) {
  std::map<std::tuple<std::size_t, std::size_t, std::size_t>, double> all;
  table.for_each([&](std::size_t i, std::size_t j, std::size_t k, float value) {
    const bool fresh = all.emplace(std::tuple(i, j, k), value).second;
    EXPECT_TRUE(fresh) << "twice: " << i << " " << j << " " << k;
    EXPECT_GE(i, j);
  });
  return all;
}

TEST(ShTripling, HasAsManyUniqueCoefficientsAsThePapers) {
  EXPECT_EQ(ShTripling::to_degree(9).unique_count(), 7042u);
  EXPECT_EQ(ShTripling::to_degree(12).unique_count(), 26450u);
  EXPECT_EQ(ShTripling::to_degree(0).unique_count(), 1u);
}

TEST(ShTripling, EveryCoefficientIsItsIntegral) {
  constexpr int kDegree = 4;
  const auto table = all_of(ShTripling::to_degree(kDegree));
  const std::size_t pair_count = coefficient_count(kDegree);
  const std::size_t third_count = coefficient_count(2 * kDegree);
  std::vector<double> integrals(pair_count * pair_count * third_count);
  constexpr int kPoints = 2 * kDegree + 1;
  for (const QuadraturePoint& point : gauss_legendre(kPoints)) {
    for (int turn = 0; turn < 2 * kPoints; ++turn) {
      const double phi = std::numbers::pi * (turn + 0.5) / kPoints;
      const double r = std::sqrt(1 - point.position * point.position);
      const auto y =
          test::harmonics_at(2 * kDegree, {r * std::cos(phi), r * std::sin(phi), point.position});
      double* sum = integrals.data();
      for (std::size_t i = 0; i < pair_count; ++i) {
        for (std::size_t j = 0; j < pair_count; ++j) {
          const double value = point.weight * std::numbers::pi / kPoints * y[i] * y[j];
          for (std::size_t k = 0; k < third_count; ++k) *sum++ += value * y[k];
        }
      }
    }
  }
  std::size_t nonzero = 0;
  for (std::size_t i = 0; i < pair_count; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      for (std::size_t k = 0; k < third_count; ++k) {
        const auto found = table.find({i, j, k});
        const double expected = integrals[(i * pair_count + j) * third_count + k];
        ASSERT_NEAR(found == table.end() ? 0 : found->second, expected, kRounding)
            << i << " " << j << " " << k;
        nonzero += std::abs(expected) > 1e-12;
      }
    }
  }
  EXPECT_EQ(nonzero, table.size()) << "what is stored is not 0, and what is not stored is";
}

TEST(ShTripling, IsSymmetricInItsFactors) {
  const auto table = all_of(ShTripling::to_degree(6));
  const std::size_t end = coefficient_count(6);
  std::size_t compared = 0;
  for (const auto& [key, value] : table) {
    const auto [i, j, k] = key;
    if (k >= end) continue;
    const auto other = table.find({std::max(i, k), std::min(i, k), j});
    ASSERT_NE(other, table.end()) << i << " " << j << " " << k;
    ASSERT_NEAR(other->second, value, kRounding);
    ++compared;
  }
  EXPECT_GT(compared, 1000u);
}

TEST(ShTripling, TheConstantLeavesEveryHarmonicAsItIs) {
  const double constant = std::sqrt(1 / (4 * std::numbers::pi));
  for (const int degree : {0, 1, 7, sh::kLargestDegree}) {
    std::size_t seen = 0;
    ShTripling::to_degree(degree).for_each(
        [&](std::size_t i, std::size_t j, std::size_t k, float value) {
          if (j == 0 || k == 0) {
            ASSERT_EQ(j == 0 ? i : j, j == 0 ? k : i);
            ASSERT_NEAR(value, constant, kRounding);
            ++seen;
          }
        });
    EXPECT_EQ(seen, 2 * coefficient_count(degree) - 1) << degree;
  }
}

// The product of two harmonics to one degree ends at twice that, so by Parseval
// ∫ (Y_i Y_i)(Y_j Y_j) dω = Σ_k C(i, i, k) C(j, j, k) = ∫ (Y_i Y_j)² dω = Σ_k C(i, j, k)².
TEST(ShTripling, AtTheLargestDegreeSumsOfSquaresAgreeWithTheSquaresOfHarmonics) {
  constexpr int kDegree = sh::kLargestDegree;
  const std::size_t i = index(kDegree, -17), j = index(kDegree - 3, 12);
  std::vector<double> first(coefficient_count(2 * kDegree)), second(first), both(first);
  ShTripling::to_degree(kDegree).for_each(
      [&](std::size_t a, std::size_t b, std::size_t k, float value) {
        if (a == i && b == i) first[k] = value;
        if (a == j && b == j) second[k] = value;
        if (a == i && b == j) both[k] = value;
      });
  double of_squares = 0, of_product = 0;
  for (std::size_t k = 0; k < both.size(); ++k) {
    of_squares += first[k] * second[k];
    of_product += both[k] * both[k];
  }
  EXPECT_GT(of_product, 0.01);
  EXPECT_NEAR(of_squares, of_product, 10 * kRounding * of_product);
}

TEST(ShTripling, ATableToALowerDegreeIsAPrefix) {
  const auto& high = ShTripling::to_degree(9).values();
  for (int degree = 0; degree < 9; ++degree) {
    const auto& low = ShTripling::to_degree(degree).values();
    ASSERT_LT(low.size(), high.size());
    for (std::size_t i = 0; i < low.size(); ++i) ASSERT_NEAR(low[i], high[i], kRounding);
  }
}

TEST(ShTripling, ManyThreadsGetTheSameTable) {
  std::vector<const ShTripling*> tables(8);
  std::vector<std::thread> threads;
  for (const ShTripling*& table : tables) {
    threads.emplace_back([&table] { table = &ShTripling::to_degree(11); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const ShTripling* table : tables) EXPECT_EQ(table, tables[0]);
  EXPECT_EQ(tables[0]->degree(), 11);
}

TEST(ShTripling, RefusesDegreesOutOfRange) {
  EXPECT_THROW(ShTripling::to_degree(-1), CheckFailure);
  EXPECT_THROW(ShTripling::to_degree(sh::kLargestDegree + 1), CheckFailure);
}

}  // namespace
}  // namespace rimlight
