#include "core/math/sampling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/statistics.h"

namespace rimlight {
namespace {

using test::Histogram;
using test::Mean;

constexpr double kSigmas = 6;
constexpr int kDraws = 200'000;
constexpr double kPi = std::numbers::pi;

double turn(double x, double y) { return (std::atan2(y, x) + kPi) / (2 * kPi); }

/// The moments of the components to second order, against their true values.
class Moments {
 public:
  void add(const Vec3d& d) {
    const double values[6] = {d.x, d.y, d.z, d.x * d.y, d.y * d.z, d.z * d.x};
    for (int i = 0; i < 6; ++i) moments_[i].add(values[i]);
    squares_[0].add(d.x * d.x);
    squares_[1].add(d.z * d.z);
  }
  void expect(double mean_z, double mean_xx, double mean_zz) const {
    for (int i = 0; i < 6; ++i) {
      EXPECT_LT(std::abs(moments_[i].score(i == 2 ? mean_z : 0)), kSigmas) << i;
    }
    EXPECT_LT(std::abs(squares_[0].score(mean_xx)), kSigmas);
    EXPECT_LT(std::abs(squares_[1].score(mean_zz)), kSigmas);
  }

 private:
  Mean moments_[6];
  Mean squares_[2];
};

TEST(UniformSphere, HasTheMomentsAndMarginalsOfTheSphere) {
  Random random(1);
  Moments moments;
  Histogram heights(128), turns(128);
  for (int i = 0; i < kDraws; ++i) {
    const Vec3d d = uniform_sphere(random_sample(random));
    ASSERT_NEAR(length(d), 1, 1e-14);
    moments.add(d);
    heights.add((d.z + 1) / 2);  // Archimedes
    turns.add(turn(d.x, d.y));
  }
  moments.expect(0, 1.0 / 3, 1.0 / 3);
  EXPECT_LT(std::abs(heights.score()), kSigmas);
  EXPECT_LT(std::abs(turns.score()), kSigmas);
}

TEST(CosineHemisphere, HasTheMomentsAndMarginalsOfTheCosine) {
  Random random(2);
  Moments moments;
  Histogram squares(128), turns(128);
  for (int i = 0; i < kDraws; ++i) {
    const Vec3d d = cosine_hemisphere(random_sample(random));
    ASSERT_NEAR(length(d), 1, 1e-14);
    ASSERT_GE(d.z, 0);
    moments.add(d);
    squares.add(d.z * d.z);  // cos²θ is uniform
    turns.add(turn(d.x, d.y));
  }
  moments.expect(2.0 / 3, 1.0 / 4, 1.0 / 2);
  EXPECT_LT(std::abs(squares.score()), kSigmas);
  EXPECT_LT(std::abs(turns.score()), kSigmas);
}

TEST(UniformDisc, IsUniformInAreaAndTurn) {
  Random random(3);
  Histogram areas(128), turns(128);
  for (int i = 0; i < kDraws; ++i) {
    const DiscPoint p = uniform_disc(random_sample(random));
    ASSERT_LE(p.x * p.x + p.y * p.y, 1 + 1e-14);
    areas.add(p.x * p.x + p.y * p.y);
    turns.add(turn(p.x, p.y));
  }
  EXPECT_LT(std::abs(areas.score()), kSigmas);
  EXPECT_LT(std::abs(turns.score()), kSigmas);
}

// Concentric: the Jacobian is π everywhere but on the diagonals, so strata keep their area.
TEST(UniformDisc, KeepsAreasPointByPoint) {
  Random random(4);
  constexpr double kStep = 1e-6;
  int checked = 0;
  for (int i = 0; i < 5000; ++i) {
    const Sample2 s = random_sample(random);
    const double a = std::abs(2 * s.u - 1), b = std::abs(2 * s.v - 1);
    if (std::abs(a - b) < 1e-4 || std::max(a, b) < 0.01) continue;
    const DiscPoint left = uniform_disc({s.u - kStep, s.v}),
                    right = uniform_disc({s.u + kStep, s.v});
    const DiscPoint down = uniform_disc({s.u, s.v - kStep}), up = uniform_disc({s.u, s.v + kStep});
    const double jacobian =
        ((right.x - left.x) * (up.y - down.y) - (right.y - left.y) * (up.x - down.x)) /
        (4 * kStep * kStep);
    EXPECT_NEAR(std::abs(jacobian), kPi, 1e-4) << s.u << " " << s.v;
    ++checked;
  }
  EXPECT_GT(checked, 4000);
}

TEST(Sampling, TheCornersOfTheSquareAreUnitDirections) {
  const double last = std::nextafter(1.0, 0.0);
  for (const double u : {0.0, 0.5, last}) {
    for (const double v : {0.0, 0.5, last}) {
      EXPECT_NEAR(length(uniform_sphere({u, v})), 1, 1e-14);
      EXPECT_NEAR(length(cosine_hemisphere({u, v})), 1, 1e-7);  // √ of a difference near 0
      EXPECT_TRUE(is_finite(cosine_hemisphere({u, v})));
    }
  }
  const DiscPoint middle = uniform_disc({0.5, 0.5});
  EXPECT_TRUE(middle.x == 0 && middle.y == 0);
}

}  // namespace
}  // namespace rimlight
