#include "core/math/vec.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/math/sampling.h"

namespace rimlight {
namespace {

Vec3d random_vector(Random& random) {
  return {random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
}

TEST(Vec3, CrossAndDotObeyTheirIdentities) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3d a = random_vector(random), b = random_vector(random), c = random_vector(random);
    EXPECT_NEAR(dot(cross(a, b), a), 0, 1e-14);
    EXPECT_EQ(cross(a, b), -cross(b, a));
    // Lagrange, and the double cross product; values to 2⁴ · 12
    EXPECT_NEAR(dot(cross(a, b), cross(a, b)), dot(a, a) * dot(b, b) - dot(a, b) * dot(a, b),
                2e-13);
    EXPECT_LT(length(cross(a, cross(b, c)) - (b * dot(a, c) - c * dot(a, b))), 1e-13);
    EXPECT_NEAR(length(normalized(a)), 1, 1e-15);
  }
  EXPECT_EQ(cross(Vec3d(1, 0, 0), Vec3d(0, 1, 0)), Vec3d(0, 0, 1));  // right-handed
}

TEST(Vec3, ComponentsAreWhatTheIndexSays) {
  Vec3f v(1, 5, 3);
  EXPECT_EQ(v[0], 1);
  EXPECT_EQ(v[1], 5);
  EXPECT_EQ(v[2], 3);
  EXPECT_EQ(max_component(v), 5);
  EXPECT_EQ(max_component(Vec3f(7, 5, 3)), 7);
  EXPECT_EQ(max_component(Vec3f(-7, -5, -3)), -3);
  v[2] = 9;
  EXPECT_EQ(v, Vec3f(1, 5, 9));
  EXPECT_EQ(Vec3d(v), Vec3d(1, 5, 9));
  v += Vec3f(1, 1, 1);
  v -= Vec3f(2, 2, 2);
  v *= 2.0f;
  v *= Vec3f(1, 0, 1);
  EXPECT_EQ(v, Vec3f(0, 0, 16));
}

TEST(Vec3, OneBrokenComponentIsEnoughNotToBeFinite) {
  for (int c = 0; c < 3; ++c) {
    for (const double value : {std::numeric_limits<double>::infinity(), std::nan("")}) {
      Vec3d v(1, 2, 3);
      EXPECT_TRUE(is_finite(v));
      v[c] = value;
      EXPECT_FALSE(is_finite(v));
    }
  }
}

template <typename T>
void expect_frame(const Vec3<T>& normal, double rounding) {
  const Frame<T> frame(normal);
  EXPECT_EQ(frame.normal, normal);
  const Vec3d t(frame.tangent), b(frame.bitangent), n(frame.normal);
  EXPECT_NEAR(length(t), 1, rounding) << n.x << " " << n.y << " " << n.z;
  EXPECT_NEAR(length(b), 1, rounding);
  EXPECT_NEAR(dot(t, b), 0, rounding);
  EXPECT_NEAR(dot(t, n), 0, rounding);
  EXPECT_NEAR(dot(b, n), 0, rounding);
  EXPECT_NEAR(length(cross(t, b) - n), 0, rounding);  // right-handed
  const Vec3<T> v(T(0.25), T(-0.5), T(2));
  EXPECT_NEAR(static_cast<double>(length(frame.to_local(frame.to_world(v)) - v)), 0, 4 * rounding);
  EXPECT_EQ(frame.to_world({0, 0, 1}), normal);
}

TEST(Frame, IsOrthonormalAndRightHandedEverywhere) {
  Random random(2);
  for (int i = 0; i < 5000; ++i) {
    const Vec3d n = uniform_sphere(random_sample(random));
    expect_frame(n, 1e-14);
    expect_frame(normalized(Vec3f(n)), 1e-6);
  }
}

TEST(Frame, TangentLiesAlongWhatItIsAskedTo) {
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const Vec3d n = uniform_sphere(random_sample(random));
    const Vec3d along = uniform_sphere(random_sample(random)) * std::pow(10, random.uniform(-6, 6));
    const Frame<double> frame(n, along);
    EXPECT_NEAR(length(frame.tangent), 1, 1e-12);
    EXPECT_NEAR(dot(frame.tangent, n), 0, 1e-9);
    EXPECT_NEAR(length(cross(n, frame.tangent) - frame.bitangent), 0, 1e-12);
    EXPECT_NEAR(dot(along, frame.bitangent), 0, 1e-9 * length(along));
    EXPECT_GT(dot(along, frame.tangent), 0);
    // Without a direction of its own: as without one.
    const Frame<double> plain(n);
    EXPECT_EQ(Frame<double>(n, {}).tangent, plain.tangent);
    EXPECT_EQ(Frame<double>(n, n * -3.0).tangent, plain.tangent);
  }
}

TEST(Frame, IsOrthonormalAtAndAroundThePoles) {
  for (const double z : {1.0, -1.0}) {
    expect_frame(Vec3d(0, 0, z), 1e-15);
    expect_frame(Vec3d(-0.0, 0, z), 1e-15);
    for (const double tilt : {1e-300, 1e-160, 1e-16, 1e-9, 1e-6, 1e-3}) {
      expect_frame(normalized(Vec3d(tilt, 0, z)), 1e-14);
      expect_frame(normalized(Vec3d(-tilt, tilt, z)), 1e-14);
      expect_frame(normalized(Vec3f(Vec3d(tilt, -tilt, z))), 1e-6);
    }
  }
  for (const double zero : {0.0, -0.0}) {  // on the equator, where the sign decides
    expect_frame(Vec3d(1, 0, zero), 1e-15);
    expect_frame(Vec3d(0, -1, zero), 1e-15);
  }
}

}  // namespace
}  // namespace rimlight
