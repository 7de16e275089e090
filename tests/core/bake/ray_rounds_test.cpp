#include "core/bake/ray_rounds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace rimlight {
namespace {

std::size_t cell_of(const Sample2& point, int side) {
  return static_cast<std::size_t>(point.v * side) * static_cast<std::size_t>(side) +
         static_cast<std::size_t>(point.u * side);
}

TEST(RayRounds, EveryReplicateAndAllTogetherAreStratified) {
  for (const int s : {1, 4, 7}) {
    Random random(2);
    const std::vector<Sample2> points = round_points(s, random);
    const auto cells = static_cast<std::size_t>(s) * static_cast<std::size_t>(s);
    ASSERT_EQ(points.size(), 4 * cells);
    std::vector<int> all(4 * cells);
    for (std::size_t r = 0; r < kReplicates; ++r) {
      std::vector<int> one(cells);
      for (std::size_t i = 0; i < cells; ++i) {
        const Sample2& point = points[r * cells + i];
        ASSERT_TRUE(point.u >= 0 && point.u < 1 && point.v >= 0 && point.v < 1);
        ++one[cell_of(point, s)];
        ++all[cell_of(point, 2 * s)];
      }
      EXPECT_EQ(one, std::vector<int>(cells, 1));
    }
    EXPECT_EQ(all, std::vector<int>(4 * cells, 1));
  }
}

/// The share of a disc in the unit square, estimated by rounds.
TEST(RayRounds, TheEstimatedErrorIsRightOrTooLargeByTwoAtMost) {
  constexpr int kTrials = 2000;
  for (const int s : {4, 8, 16}) {
    Random random(7);
    double squares = 0, estimated = 0, sum = 0;
    const double truth = 3.141592653589793 * 0.09;
    for (int trial = 0; trial < kTrials; ++trial) {
      const std::vector<Sample2> points = round_points(s, random);
      ReplicateMean mean(1);
      const std::size_t cells = points.size() / kReplicates;
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (std::hypot(points[i].u - 0.45, points[i].v - 0.52) < 0.3) {
          mean.replicate(i / cells)[0] += 1 / static_cast<double>(cells);
        }
      }
      const double difference = mean.mean(0) - truth;
      sum += difference;
      squares += difference * difference;
      estimated += mean.error() * mean.error();
    }
    const double error = std::sqrt(squares / kTrials), guess = std::sqrt(estimated / kTrials);
    EXPECT_LT(std::abs(sum / kTrials), 5 * error / std::sqrt(kTrials)) << "biased";
    EXPECT_GT(guess, 0.95 * error) << s;
    EXPECT_LT(guess, 2.2 * error) << s;
  }
}

TEST(RayRounds, GoOnUntilTheErrorOrTheCapIsReached) {
  const RaySettings settings{.degree = 10, .error = 0.01, .most_rays = 4096, .seed = 1};
  const int first = first_round(settings);
  EXPECT_GE(4 * first * first, std::sqrt(3.1415) / 0.01);
  EXPECT_EQ(next_round(settings, first, 0.01), 0);
  EXPECT_EQ(next_round(settings, first, 0), 0);
  int s = first, rounds = 0;
  for (; next_round(settings, s, 0.011) != 0; ++rounds) {
    ASSERT_GT(next_round(settings, s, 0.011), s);
    s = next_round(settings, s, 0.011);
  }
  EXPECT_EQ(s, 32);  // 4 · 32² = 4096
  EXPECT_GT(rounds, 1);
  EXPECT_EQ(next_round(settings, first, 1e9), 32);
  EXPECT_EQ(first_round({.degree = 3, .error = 1e-4, .most_rays = 64, .seed = 1}), 4);
}

}  // namespace
}  // namespace rimlight
