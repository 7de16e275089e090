#include "core/material/half_difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/math/random.h"
#include "core/math/sampling.h"

namespace rimlight {
namespace {

constexpr double kPi = std::numbers::pi;

Vec3d random_hemisphere(Random& random) {
  Vec3d v = uniform_sphere(random_sample(random));
  v.z = std::abs(v.z);
  return v;
}

Vec3d turned(const Vec3d& v, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * v.x - s * v.y, s * v.x + c * v.y, v.z};
}

// Rusinkiewicz's own way: turn by −φ_h about the normal, then by −θ_h about the bitangent.
HalfDifference by_rotations(const Vec3d& in, const Vec3d& out) {
  const Vec3d half = normalized(in + out);
  const double theta = std::acos(half.z), phi = std::atan2(half.y, half.x);
  const Vec3d flat = turned(in, -phi);
  const double c = std::cos(-theta), s = std::sin(-theta);
  const Vec3d d{c * flat.x + s * flat.z, flat.y, c * flat.z - s * flat.x};
  return {theta, std::acos(std::min(1.0, d.z)), std::atan2(d.y, d.x)};
}

TEST(HalfDifference, AgreesWithRusinkiewiczsRotations) {
  Random random(1);
  for (int i = 0; i < 5000; ++i) {
    const Vec3d in = random_hemisphere(random), out = random_hemisphere(random);
    const HalfDifference got = half_difference(in, out), want = by_rotations(in, out);
    ASSERT_NEAR(got.half, want.half, 1e-6);
    ASSERT_NEAR(got.difference, want.difference, 1e-6);
    const double turn = got.azimuth - want.azimuth;
    // An angle about a pole is as sure as the circle is wide.
    ASSERT_NEAR(std::remainder(turn, 2 * kPi) * std::sin(got.difference) * std::sin(got.half), 0,
                1e-6);
  }
}

TEST(HalfDifference, PairHasItsAnglesAgain) {
  Random random(2);
  for (int i = 0; i < 5000; ++i) {
    const HalfDifference angles{random.uniform(1e-6, kPi / 2), random.uniform(1e-6, kPi / 2),
                                random.uniform(-kPi, kPi)};
    const DirectionPair pair = direction_pair(angles);
    ASSERT_NEAR(length(pair.in), 1, 1e-14);
    ASSERT_NEAR(length(pair.out), 1, 1e-14);
    const HalfDifference again = half_difference(pair.in, pair.out);
    ASSERT_NEAR(again.half, angles.half, 1e-9);
    ASSERT_NEAR(again.difference, angles.difference, 1e-9);
    ASSERT_NEAR(std::remainder(again.azimuth - angles.azimuth, 2 * kPi), 0, 1e-8);
  }
}

TEST(HalfDifference, ExchangingDirectionsTurnsTheAzimuthByPi) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const Vec3d in = random_hemisphere(random), out = random_hemisphere(random);
    const HalfDifference there = half_difference(in, out), back = half_difference(out, in);
    ASSERT_NEAR(there.half, back.half, 1e-15);
    ASSERT_NEAR(there.difference, back.difference, 1e-15);
    ASSERT_NEAR(std::abs(std::remainder(there.azimuth - back.azimuth, 2 * kPi)), kPi, 1e-9);
  }
}

TEST(HalfDifference, OppositeAndEqualDirectionsAreFinite) {
  const HalfDifference opposite = half_difference({1, 0, 0}, {-1, 0, 0});
  EXPECT_EQ(opposite.half, kPi / 2);
  EXPECT_EQ(opposite.difference, kPi / 2);
  const HalfDifference equal = half_difference({0, 0, 1}, {0, 0, 1});
  EXPECT_EQ(equal.half, 0);
  EXPECT_EQ(equal.difference, 0);
  // A half vector a hundred-millionth off the normal keeps its angle.
  EXPECT_NEAR(half_difference({1e-8, 0, 1}, {1e-8, 0, 1}).half / 1e-8, 1, 1e-12);
}

}  // namespace
}  // namespace rimlight
