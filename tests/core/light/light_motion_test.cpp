#include "core/light/light_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <iostream>
#include <numbers>
#include <vector>

#include "core/base/check.h"
#include "core/math/sampling.h"
#include "tests/core/light/light_samples.h"

namespace rimlight {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// The angle of each step: [frames − 1].
std::vector<double> steps_of(const EasedTurn& turn) {
  std::vector<double> steps;
  for (int frame = 1; frame < turn.frames; ++frame) {
    steps.push_back(turn.angle(frame) - turn.angle(frame - 1));
  }
  return steps;
}

TEST(EasedTurn, SpeedsUpToItsPeakKeepsItAndSlowsDown) {
  const EasedTurn turn{{0, 1, 0}, 3 * kDegree, 100, 60, 30};
  const std::vector<double> steps = steps_of(turn);
  ASSERT_EQ(steps.size(), 99u);
  EXPECT_GT(steps.front(), 0);
  EXPECT_LT(steps.front(), 0.01 * turn.peak);
  EXPECT_LT(steps.back(), 0.01 * turn.peak);
  EXPECT_GT(steps.back(), 0);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (i > 0 && i < 60) {
      EXPECT_GT(steps[i], steps[i - 1]) << i;
    }
    if (i >= 60 && i < 69) {
      EXPECT_NEAR(steps[i], turn.peak, 1e-12) << i;
    }
    if (i > 69) {
      EXPECT_LT(steps[i], steps[i - 1]) << i;
    }
    EXPECT_LE(steps[i], turn.peak + 1e-12) << i;
  }
}

/// No step differs from the next by more than the steepest slope of 3x² − 2x³, which is 3/2.
TEST(EasedTurn, ItsSpeedHasNoJumps) {
  for (const EasedTurn& turn : {EasedTurn{{0, 1, 0}, 1, 100, 60, 30},
                                {{0, 1, 0}, 1, 40, 19, 20},
                                {{1, 0, 0}, 1, 10'000, 9000, 999}}) {
    std::vector<double> steps = steps_of(turn);
    steps.insert(steps.begin(), 0.0);
    steps.push_back(0);
    const double steepest = 1.5 / std::min(turn.ease_in, turn.ease_out);
    for (std::size_t i = 1; i < steps.size(); ++i) {
      ASSERT_LE(std::abs(steps[i] - steps[i - 1]), steepest) << i;
    }
  }
}

/// Easing takes half of the speed on average.
TEST(EasedTurn, TurnsByItsFullStepsAndHalfOfItsEasedOnes) {
  for (const auto& [frames, in, out] : std::vector<std::array<int, 3>>{
           {100, 60, 30}, {100, 0, 0}, {100, 99, 0}, {100, 0, 99}, {2, 1, 0}, {2, 0, 0}}) {
    const EasedTurn turn{{0, 1, 0}, 0.05, frames, in, out};
    const double expected = 0.05 * (frames - 1 - 0.5 * (in + out));
    EXPECT_NEAR(turn.angle(frames - 1), expected, 1e-12) << frames << " " << in << " " << out;
    EXPECT_EQ(turn.angle(0), 0);
    EXPECT_EQ(turn.angle(frames), turn.angle(frames - 1));
    EXPECT_EQ(turn.rotation(frames + 1000), turn.rotation(frames - 1));
  }
}

TEST(EasedTurn, ItsRotationsTurnAboutItsAxis) {
  const EasedTurn turn{{1, 2, -2}, 0.05, 100, 20, 20};
  EXPECT_EQ(turn.rotation(0), Quaternion{});
  for (const int frame : {1, 50, 99}) {
    const Quaternion q = turn.rotation(frame);
    EXPECT_NEAR(norm(q), 1, 1e-12);
    EXPECT_NEAR(2 * std::acos(q.w), turn.angle(frame), 1e-9);
    EXPECT_NEAR(length(rotated(q, turn.axis) - turn.axis), 0, 1e-12);
  }
}

TEST(EasedTurn, RefusesMoreEasingThanItHasSteps) {
  EXPECT_THROW((EasedTurn{{0, 1, 0}, 1, 10, 5, 5}.angle(0)), CheckFailure);
  EXPECT_THROW((EasedTurn{{0, 1, 0}, 1, 10, -1, 5}.angle(0)), CheckFailure);
  EXPECT_THROW((EasedTurn{{0, 1, 0}, 1, 1, 0, 0}.angle(0)), CheckFailure);
  EXPECT_THROW((EasedTurn{{0, 1, 0}, 1, 10, 5, 4}.angle(-1)), CheckFailure);
}

TEST(EasedShare, RisesFromNoneToAllAndStays) {
  for (const int frames : {2, 3, 100, 10'000}) {
    EXPECT_EQ(eased_share(0, frames), 0);
    EXPECT_EQ(eased_share(frames - 1, frames), 1);
    EXPECT_EQ(eased_share(frames + 5, frames), 1);
    for (int frame = 1; frame < frames; ++frame) {
      ASSERT_GT(eased_share(frame, frames), eased_share(frame - 1, frames)) << frame;
      ASSERT_NEAR(eased_share(frame, frames) + eased_share(frames - 1 - frame, frames), 1, 1e-12);
    }
  }
}

TEST(SpherePath, GoesThroughItsPointsAtOneSpeed) {
  Random random(81);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<Vec3d> points(5);
    for (Vec3d& point : points) point = uniform_sphere(random_sample(random));
    const SpherePath path(points);
    double way = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (i > 0) way += angle_between(points[i - 1], points[i]);
      EXPECT_LE(angle_between(path.at(way / path.length()), points[i]), 1e-9);
    }
    EXPECT_NEAR(path.length(), way, 1e-12);
    EXPECT_EQ(path.at(0), points.front());
    EXPECT_EQ(path.at(1), points.back());
    constexpr int kSteps = 1000;
    for (int i = 1; i <= kSteps; ++i) {
      const Vec3d a = path.at((i - 1.0) / kSteps), b = path.at(static_cast<double>(i) / kSteps);
      ASSERT_NEAR(length(b), 1, 1e-12);
      // Exact within an arc, a short cut at a corner.
      ASSERT_LE(angle_between(a, b), path.length() / kSteps + 1e-9);
    }
  }
}

TEST(SpherePath, AcceptsOnePointAndPointsTwice) {
  const Vec3d up{0, 1, 0}, right{1, 0, 0};
  EXPECT_EQ(SpherePath({up}).at(0.7), up);
  EXPECT_EQ(SpherePath({up, up}).at(0.5), up);
  const SpherePath path({up, up, right, right});
  EXPECT_NEAR(path.at(0.5).x, std::sqrt(0.5), 1e-12);
  EXPECT_LE(angle_between(path.at(std::nextafter(1.0, 0.0)), right), 1e-12);
  EXPECT_EQ(path.at(1), right);
}

TEST(SpherePath, RefusesWhatIsNoPath) {
  EXPECT_THROW(SpherePath({}), CheckFailure);
  EXPECT_THROW(SpherePath({{0, 2, 0}}), CheckFailure);
  EXPECT_THROW(SpherePath({{0, 1, 0}, {0, -1, 0}}), CheckFailure);
  EXPECT_THROW(SpherePath({{std::nan(""), 1, 0}}), CheckFailure);
}

std::vector<FlickerSettings> telling_flickers() {
  return {{0.4, 100, 3, 20, 1},    {1, 100, 1, 49, 2},       {0.1, 4, 1, 1, 3},
          {1, 10'000, 5, 4999, 4}, {0.7, 1000, 400, 400, 5}, {0, 50, 1, 5, 6}};
}

TEST(Flicker, StaysWithinItsAmountAndReachesIt) {
  for (const FlickerSettings& settings : telling_flickers()) {
    const Flicker flicker(settings);
    ASSERT_EQ(flicker.frames(), settings.frames);
    double largest = 0, sum = 0;
    for (int frame = 0; frame < settings.frames - 1; ++frame) {
      largest = std::max(largest, std::abs(flicker.factor(frame) - 1));
      sum += flicker.factor(frame);
    }
    EXPECT_NEAR(largest, settings.amount, 1e-12);
    EXPECT_LE(largest, settings.amount + 1e-15) << "a factor may never be negative";
    EXPECT_NEAR(sum / (settings.frames - 1), 1, 1e-12);
  }
}

TEST(Flicker, EndsAsItBeganAndStays) {
  for (const FlickerSettings& settings : telling_flickers()) {
    const Flicker flicker(settings);
    for (const int after : {0, 1, 1000}) {
      EXPECT_EQ(flicker.factor(settings.frames - 1 + after), flicker.factor(0));
    }
  }
}

/// By a Fourier sum over one period, frequency by frequency.
TEST(Flicker, HasNoFrequencyOutsideItsBand) {
  for (const FlickerSettings& settings : telling_flickers()) {
    if (settings.frames > 1000 || settings.amount == 0) continue;
    const Flicker flicker(settings);
    const int period = settings.frames - 1;
    int within = 0;
    for (int cycles = 1; 2 * cycles < period; ++cycles) {
      std::complex<double> sum = 0;
      for (int frame = 0; frame < period; ++frame) {
        const double angle = 2 * std::numbers::pi * cycles * frame / period;
        sum += flicker.factor(frame) * std::polar(1.0, -angle);
      }
      const double strength = std::abs(sum) / period;
      const bool in_band = cycles >= settings.lowest_cycles && cycles <= settings.highest_cycles;
      if (!in_band) {
        ASSERT_LE(strength, 1e-11) << cycles;
      }
      within += in_band && strength > 1e-3 * settings.amount;
    }
    EXPECT_EQ(within, settings.highest_cycles - settings.lowest_cycles + 1);
  }
}

TEST(Flicker, IsSeeded) {
  const Flicker a({0.5, 100, 2, 30, 7}), again({0.5, 100, 2, 30, 7}), b({0.5, 100, 2, 30, 8});
  int different = 0;
  for (int frame = 0; frame < 99; ++frame) {
    EXPECT_EQ(a.factor(frame), again.factor(frame));
    different += a.factor(frame) != b.factor(frame);
  }
  EXPECT_GT(different, 90);
}

TEST(Flicker, RefusesWhatIsNoFlicker) {
  const double nan = std::nan("");
  for (const FlickerSettings& bad : std::vector<FlickerSettings>{{1.1, 100, 1, 2, 1},
                                                                 {-0.1, 100, 1, 2, 1},
                                                                 {nan, 100, 1, 2, 1},
                                                                 {0.5, 100, 0, 2, 1},
                                                                 {0.5, 100, 3, 2, 1},
                                                                 {0.5, 101, 1, 50, 1},
                                                                 {0.5, 2, 1, 1, 1}}) {
    EXPECT_THROW(Flicker{bad}, CheckFailure);
  }
}

}  // namespace
}  // namespace rimlight
