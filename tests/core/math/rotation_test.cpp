#include "core/math/rotation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/math/sampling.h"
#include "tests/support/statistics.h"

namespace rimlight {
namespace {

using test::Histogram;
using test::Mean;

constexpr double kRounding = 1e-14;  // a few dozen roundings of numbers near 1
constexpr double kPi = std::numbers::pi;

double distance(const Vec3d& a, const Vec3d& b) { return length(a - b); }

/// Quaternions q and −q are one rotation.
double distance(const Quaternion& a, const Quaternion& b) {
  const auto apart = [&](double sign) {
    return norm({a.x - sign * b.x, a.y - sign * b.y, a.z - sign * b.z, a.w - sign * b.w});
  };
  return std::min(apart(1), apart(-1));
}

/// v turned by `angle` about a unit axis (Rodrigues 1840).
Vec3d turned(const Vec3d& axis, double angle, const Vec3d& v) {
  return v * std::cos(angle) + cross(axis, v) * std::sin(angle) +
         axis * (dot(axis, v) * (1 - std::cos(angle)));
}

TEST(Rotation, OfAxisAndAngleIsThatOfRodrigues) {
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const Vec3d axis = uniform_sphere(random_sample(random));
    const double angle = random.uniform(-7, 7);
    const Vec3d v = uniform_sphere(random_sample(random));
    const Quaternion q = axis_angle(axis * random.uniform(0.01, 100), angle);
    EXPECT_NEAR(norm(q), 1, kRounding);
    EXPECT_LT(distance(rotated(q, v), turned(axis, angle, v)), kRounding);
  }
}

TEST(Rotation, AQuarterTurnAboutYTakesZToX) {
  EXPECT_LT(distance(rotated(axis_angle({0, 1, 0}, kPi / 2), {0, 0, 1}), {1, 0, 0}), kRounding);
  EXPECT_EQ(rotated(Quaternion(), {1, 2, 3}), Vec3d(1, 2, 3));
}

TEST(Rotation, TheProductTurnsByTheSecondFirst) {
  Random random(2);
  for (int i = 0; i < 2000; ++i) {
    const Quaternion a = random_rotation(random), b = random_rotation(random);
    const Quaternion c = random_rotation(random);
    const Vec3d v = uniform_sphere(random_sample(random));
    EXPECT_LT(distance(rotated(a * b, v), rotated(a, rotated(b, v))), kRounding);
    EXPECT_LT(distance((a * b) * c, a * (b * c)), kRounding);
    EXPECT_NEAR(norm(a * b), 1, kRounding);
  }
}

TEST(Rotation, TheConjugateTurnsBack) {
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const Quaternion q = random_rotation(random);
    const Vec3d v = uniform_sphere(random_sample(random));
    EXPECT_LT(distance(rotated(conjugate(q), rotated(q, v)), v), kRounding);
    EXPECT_LT(distance(q * conjugate(q), Quaternion()), kRounding);
  }
}

TEST(Rotation, TheMatrixTurnsAsTheQuaternionAndKeepsAnglesAndHands) {
  Random random(4);
  for (int i = 0; i < 2000; ++i) {
    const Quaternion q = random_rotation(random);
    const Matrix3 m = matrix(q);
    const Vec3d a = uniform_sphere(random_sample(random)),
                b = uniform_sphere(random_sample(random));
    // q a q*, by the quaternion product alone
    const Quaternion turned = q * Quaternion{a.x, a.y, a.z, 0} * conjugate(q);
    EXPECT_LT(distance(m * a, {turned.x, turned.y, turned.z}), kRounding);
    EXPECT_NEAR(turned.w, 0, kRounding);
    EXPECT_NEAR(dot(m * a, m * b), dot(a, b), kRounding);
    EXPECT_LT(distance(cross(m * a, m * b), m * cross(a, b)), kRounding);
  }
}

TEST(Rotation, NormalizedKeepsTheDirectionAtAnyScale) {
  Random random(5);
  for (const double scale : {1e-300, 1e-9, 1.0, 1e9, 1e300}) {
    const Quaternion q = random_rotation(random);
    EXPECT_LT(distance(normalized({q.x * scale, q.y * scale, q.z * scale, q.w * scale}), q),
              kRounding);
  }
}

// A rotation is uniform when its angle has the density (1 − cos θ)/π on [0, π], its axis is uniform
// and both are independent.
TEST(RandomRotation, IsUniform) {
  Random random(6);
  Histogram angles(128), heights(128), turns(128);
  Mean relation;
  for (int i = 0; i < 200'000; ++i) {
    Quaternion q = random_rotation(random);
    ASSERT_NEAR(norm(q), 1, kRounding);
    if (q.w < 0) q = {-q.x, -q.y, -q.z, -q.w};
    const double sine = std::hypot(q.x, q.y, q.z);
    const double angle = 2 * std::atan2(sine, q.w);
    angles.add((angle - std::sin(angle)) / kPi);
    heights.add((q.z / sine + 1) / 2);
    turns.add((std::atan2(q.y, q.x) + kPi) / (2 * kPi));
    relation.add((q.z / sine) * (angle - kPi / 2 - 2 / kPi));  // mean angle: π/2 + 2/π
  }
  EXPECT_LT(std::abs(angles.score()), 6);
  EXPECT_LT(std::abs(heights.score()), 6);
  EXPECT_LT(std::abs(turns.score()), 6);
  EXPECT_LT(std::abs(relation.score(0)), 6);
}

}  // namespace
}  // namespace rimlight
