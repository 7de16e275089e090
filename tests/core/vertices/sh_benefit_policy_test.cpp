#include "core/vertices/sh_benefit_policy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/check.h"
#include "core/basis/sh_projection.h"
#include "core/basis/sh_rotation.h"
#include "core/light/environment.h"
#include "core/vertices/sh_band_policy.h"
#include "tests/core/vertices/random_vertices.h"

namespace rimlight {
namespace {

using test::RandomVertices;

TEST(ColumnEnergies, AreSquaresSummedOverVertices) {
  for (const std::size_t channels : {1u, 3u}) {
    const RandomVertices made(
        {.vertices = 150, .highlights = 0, .irradiance_degree = 3, .channels = channels});
    const VertexTransportView view = made.view();
    const auto energies = column_energies(view);
    ASSERT_EQ(energies.size(), 3 * 16u);
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < 16; ++i) {
        double sum = 0;
        for (std::size_t batch = 0; batch < 3; ++batch) {
          const std::size_t channel = channels == 1 ? 0 : c;
          for (std::size_t lane = 0; lane < kBatchVertices; ++lane) {
            const std::size_t at = ((batch * channels + channel) * 16 + i) * kBatchVertices + lane;
            sum += std::pow(double{to_float(view.irradiance[at])}, 2);
          }
        }
        EXPECT_NEAR(energies[c * 16 + i], sum, 1e-6 * sum);
      }
    }
  }
}

TEST(ShBenefitPolicy, TakesWhatLowersTheErrorMost) {
  ShBenefitPolicy policy({4, 1, 0, 9,  //
                          1, 1, 0, 0,  //
                          1, 1, 0, 0});
  const std::vector<float> held(12);
  // Gains: 4·1 + 0, 1·9, 0 (nothing sees it), 9·0.25 + 0.
  const std::vector<float> target = {1, 3, 7, 0.5f, 0, 0, 7, 1, 0, 0, 7, 1};
  EXPECT_THAT(policy.choose(target, held, 1), testing::ElementsAre(1u));
  EXPECT_THAT(policy.choose(target, held, 2), testing::ElementsAre(0u, 1u));
  EXPECT_THAT(policy.choose(target, held, 9), testing::ElementsAre(0u, 1u, 3u));
  EXPECT_THAT(policy.choose(target, held, 0), testing::IsEmpty());
  EXPECT_THAT(policy.choose(held, held, 4), testing::IsEmpty());
}

/// Errors of what a light that turns about the vertical does to vertices whose columns fall with
/// the degree as those of shadowed matte surfaces do, over some frames; relative.
struct TurnErrors {
  double benefit = 0, band = 0, linear_25 = 0, linear_100 = 0;
};
TurnErrors turn(const char* light, double degrees_per_frame) {
  constexpr int kDegree = 19;
  constexpr std::size_t kCount = sh::coefficient_count(kDegree);
  const auto source =
      sh::project(sh::cube_quadrature(32), builtin_environment(light).project(32).values, kDegree);
  std::vector<float> energies(3 * kCount);
  for (std::size_t i = 0; i < energies.size(); ++i) {
    energies[i] = static_cast<float>(std::pow(1 + sh::degree_of(i % kCount), -2));
  }
  ShBenefitPolicy benefit(energies);
  ShBandPolicy band(kDegree);
  auto by_benefit = source, by_band = source, target = source;
  TurnErrors sums;
  double whole = 0;
  for (int frame = 1; frame <= 60; ++frame) {
    const double half = frame * degrees_per_frame / 360 * std::numbers::pi;
    sh::Rotation({0, std::sin(half), 0, std::cos(half)}, kDegree).apply(source, target);
    const auto update = [&](std::span<const std::uint32_t> chosen, std::vector<float>& held) {
      EXPECT_EQ(chosen.size(), 25u);
      for (const std::uint32_t i : chosen) {
        for (std::size_t c = 0; c < 3; ++c) held[c * kCount + i] = target[c * kCount + i];
      }
    };
    update(benefit.choose(target, by_benefit, 25), by_benefit);
    update(band.choose(target, by_band, 25), by_band);
    for (std::size_t i = 0; i < target.size(); ++i) {
      const auto error = [&](double shown) {
        return energies[i] * (target[i] - shown) * (target[i] - shown);
      };
      sums.benefit += error(by_benefit[i]);
      sums.band += error(by_band[i]);
      sums.linear_25 += error(i % kCount < 25 ? target[i] : 0);
      sums.linear_100 += error(i % kCount < 100 ? target[i] : 0);
      whole += error(0);
    }
  }
  for (double* const sum : {&sums.benefit, &sums.band, &sums.linear_25, &sums.linear_100}) {
    *sum = std::sqrt(*sum / whole);
  }
  return sums;
}

TEST(ShBenefitPolicy, OfTwentyFiveIsAsGoodAsAHundredLinearOnesUnderATurningLight) {
  for (const char* const light : {"sunny", "studio", "cathedral"}) {
    const TurnErrors slow = turn(light, 0.25), fast = turn(light, 1);
    EXPECT_LT(fast.benefit, fast.linear_100) << light;
    EXPECT_LT(slow.benefit, 0.4 * slow.linear_100) << light;
    EXPECT_LT(fast.benefit, 0.5 * fast.band) << light;
    // The paper's way is as good as that in slow turns only.
    EXPECT_LT(slow.band, 1.3 * slow.linear_100) << light;
    EXPECT_LT(slow.band, 0.8 * slow.linear_25) << light;
    EXPECT_LT(slow.linear_100, 0.8 * slow.linear_25) << light;  // the comparison means something
  }
}

TEST(ShBenefitPolicy, RefusesWhatDoesNotFit) {
  EXPECT_THROW(ShBenefitPolicy(std::vector<float>(4)), CheckFailure);
  EXPECT_THROW(ShBenefitPolicy({1, -1, 1}), CheckFailure);
  EXPECT_THROW(ShBenefitPolicy({1, NAN, 1}), CheckFailure);
  ShBenefitPolicy policy({1, 1, 1});
  EXPECT_THROW(policy.choose(std::vector<float>(3), std::vector<float>(6), 1), CheckFailure);
}

}  // namespace
}  // namespace rimlight
