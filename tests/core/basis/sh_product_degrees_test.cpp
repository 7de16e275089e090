// Increments of the product of transport and light, degree by degree.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/check.h"
#include "core/basis/sh_product_matrix.h"
#include "tests/core/basis/sh_product_cases.h"
#include "tests/support/every_target.h"

namespace rimlight {
namespace {

using sh::coefficient_count;
constexpr std::size_t kChannels = ShProductMatrix::kChannels;

struct Case {
  ShProductMatrix matrix;
  std::size_t lanes;
  std::vector<float> transport;

  Case(int degree, std::size_t lane_count, std::uint64_t seed)
      : matrix(degree), lanes(lane_count), transport(matrix.size() * lanes) {
    std::vector<float> light;
    for (std::size_t c = 0; c < kChannels; ++c) {
      const auto channel = test::random_coefficients(2 * degree, seed + c);
      light.insert(light.end(), channel.begin(), channel.end());
    }
    matrix.set_light(light);
    Random random(seed);
    for (float& value : transport) value = static_cast<float>(random.uniform(-1, 1));
  }

  std::vector<float> zeros() const { return std::vector<float>(kChannels * transport.size()); }

  /// Rows and columns below the degree's end only, in double.
  double expected(std::size_t channel, std::size_t i, std::size_t lane, int degree,
                  double& magnitude) const {
    double sum = 0;
    magnitude = 0;
    for (std::size_t j = 0; j < coefficient_count(degree); ++j) {
      const double term =
          static_cast<double>(matrix.row(channel, i)[j]) * transport[j * lanes + lane];
      sum += term;
      magnitude += std::abs(term);
    }
    return sum;
  }
};

/// Whether `product` is the whole product of everything to a degree. A sum of k terms in fp32, in
/// whatever pieces, is off by k roundings of its magnitude at most; rows above are 0.
void expect_whole(const Case& c, int degree, std::span<const float> product) {
  const std::size_t end = coefficient_count(degree);
  for (std::size_t channel = 0; channel < kChannels; ++channel) {
    for (std::size_t i = 0; i < c.matrix.size(); ++i) {
      for (std::size_t lane = 0; lane < c.lanes; ++lane) {
        const float value = product[(channel * c.matrix.size() + i) * c.lanes + lane];
        double magnitude = 0;
        const double expected = i < end ? c.expected(channel, i, lane, degree, magnitude) : 0;
        ASSERT_NEAR(value, expected, static_cast<double>(end) * 0x1p-24 * magnitude)
            << degree << ": " << channel << " " << i << " " << lane;
      }
    }
  }
}

TEST(ShProductDegrees, IncrementsSumToTheFullCalculationAtEveryDegree) {
  for (const int degree : {0, 1, 2, 6, 10}) {
    const Case c(degree, 48, 1);
    const int targets = test::for_every_target([&] {
      std::vector<float> product = c.zeros();
      for (int l = 0; l <= degree; ++l) {
        add_product_degrees(c.matrix, {l, l}, c.transport, product, c.lanes);
        expect_whole(c, l, product);
      }
    });
    EXPECT_GT(targets, 0);
  }
}

TEST(ShProductDegrees, AllDegreesAtOnceAreTheFullCalculation) {
  for (const std::size_t lanes : {16u, 32u, 80u}) {
    const Case c(9, lanes, 2);
    test::for_every_target([&] {
      std::vector<float> product = c.zeros();
      add_product_degrees(c.matrix, {0, 9}, c.transport, product, lanes);
      expect_whole(c, 9, product);
    });
  }
}

TEST(ShProductDegrees, AnySplitAddsUp) {
  const Case c(8, 16, 3);
  for (int first_end = 0; first_end < 7; ++first_end) {
    for (int second_end = first_end + 1; second_end < 8; ++second_end) {
      std::vector<float> product = c.zeros();
      add_product_degrees(c.matrix, {0, first_end}, c.transport, product, c.lanes);
      add_product_degrees(c.matrix, {first_end + 1, second_end}, c.transport, product, c.lanes);
      add_product_degrees(c.matrix, {second_end + 1, 8}, c.transport, product, c.lanes);
      expect_whole(c, 8, product);
    }
  }
}

// The slip of the thesis' Algorithm 3: what it adds to the lower rows' share of the result is all
// of R again. An increment must vanish where the new degree of the transport does.
TEST(ShProductDegrees, AnIncrementHoldsNothingOfLowerDegreesForLowerRows) {
  constexpr int kDegree = 5;
  Case c(kDegree, 16, 4);
  std::fill(
      c.transport.begin() + static_cast<std::ptrdiff_t>(coefficient_count(kDegree - 1) * c.lanes),
      c.transport.end(), 0.0f);
  std::vector<float> product = c.zeros();
  add_product_degrees(c.matrix, {kDegree, kDegree}, c.transport, product, c.lanes);
  double of_new_rows = 0;
  for (std::size_t channel = 0; channel < kChannels; ++channel) {
    for (std::size_t i = 0; i < c.matrix.size() * c.lanes; ++i) {
      const float value = product[channel * c.transport.size() + i];
      if (i < coefficient_count(kDegree - 1) * c.lanes) {
        ASSERT_EQ(value, 0);
      } else {
        of_new_rows += std::abs(value);
      }
    }
  }
  EXPECT_GT(of_new_rows, 1) << "the lower degrees do reach the new rows";
}

TEST(ShProductDegrees, CountsTheOperationsOfEachSplit) {
  EXPECT_EQ(product_degrees_flops({0, 0}), 6);
  EXPECT_EQ(product_degrees_flops({0, 10}), 2 * 3 * 121 * 121);
  double sum = 0;
  for (int l = 0; l <= 10; ++l) sum += product_degrees_flops({l, l});
  EXPECT_EQ(sum, product_degrees_flops({0, 10}));
}

TEST(ShProductDegrees, RefusesDegreesAndSizesOutOfRange) {
  const Case c(3, 16, 5);
  std::vector<float> product = c.zeros();
  const auto add = [&](const ShDegreeRange& degrees) {
    add_product_degrees(c.matrix, degrees, c.transport, product, c.lanes);
  };
  EXPECT_THROW(add({-1, 3}), CheckFailure);
  EXPECT_THROW(add({2, 1}), CheckFailure);
  EXPECT_THROW(add({0, 4}), CheckFailure);
  EXPECT_THROW(add_product_degrees(c.matrix, {0, 3}, c.transport, product, 8), CheckFailure);
  EXPECT_THROW(add_product_degrees(c.matrix, {0, 3}, c.transport, product, 32), CheckFailure);
  const std::span<float> part(product.data(), c.transport.size());
  EXPECT_THROW(add_product_degrees(c.matrix, {0, 3}, c.transport, part, 16), CheckFailure);
  EXPECT_EQ(product, c.zeros());
}

}  // namespace
}  // namespace rimlight
