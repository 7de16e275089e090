#include "core/math/camera.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "core/base/error.h"
#include "core/math/sampling.h"
#include "tests/support/error_of.h"

namespace rimlight {
namespace {

constexpr double kRounding = 1e-14;

Camera random_camera(Random& random) {
  Camera camera;
  camera.position = uniform_sphere(random_sample(random)) * 4.0;
  camera.target = uniform_sphere(random_sample(random));
  camera.up = uniform_sphere(random_sample(random)) * 3.0;  // any length, not perpendicular
  camera.vertical_field_of_view_degrees = random.uniform(5, 120);
  return camera;
}

double angle_degrees(const Vec3d& a, const Vec3d& b) {
  return std::atan2(length(cross(a, b)), dot(a, b)) * 180 / std::numbers::pi;
}

TEST(Camera, TheMiddleLooksAtTheTarget) {
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    const Camera camera = random_camera(random);
    const Vec3d expected = normalized(camera.target - camera.position);
    EXPECT_LT(length(camera.ray_direction(32, 24, 64, 48) - expected), kRounding);
    EXPECT_LT(length(camera.ray_direction(0.5, 1.5, 1, 3) - expected), kRounding);
  }
}

TEST(Camera, TopAndBottomAreTheFieldOfViewApart) {
  Random random(2);
  for (int i = 0; i < 500; ++i) {
    const Camera camera = random_camera(random);
    const Vec3d top = camera.ray_direction(32, 0, 64, 48);
    const Vec3d bottom = camera.ray_direction(32, 48, 64, 48);
    EXPECT_NEAR(angle_degrees(top, bottom), camera.vertical_field_of_view_degrees, 1e-11);
    EXPECT_GT(dot(top - bottom, camera.up), 0);  // row 0 is the top
  }
}

TEST(Camera, CornersFollowFromTheFieldOfViewAndTheShape) {
  // From +z towards the origin: right is +x, up is +y; at distance 1 the image is 2t high.
  const Camera camera;
  const double t = std::tan(20 * std::numbers::pi / 180);
  const double s = t * 64 / 48;
  EXPECT_LT(length(camera.ray_direction(0, 0, 64, 48) - normalized(Vec3d(-s, t, -1))), kRounding);
  EXPECT_LT(length(camera.ray_direction(64, 0, 64, 48) - normalized(Vec3d(s, t, -1))), kRounding);
  EXPECT_LT(length(camera.ray_direction(64, 48, 64, 48) - normalized(Vec3d(s, -t, -1))), kRounding);
}

TEST(Camera, PixelsAreSquareAndEvenOnThePlane) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Camera camera = random_camera(random);
    const Vec3d forward = normalized(camera.target - camera.position);
    const auto on_plane = [&](double x, double y) {
      const Vec3d d = camera.ray_direction(x, y, 90, 40);
      EXPECT_NEAR(length(d), 1, kRounding);
      return d / dot(d, forward);
    };
    const Vec3d right = on_plane(11, 20) - on_plane(10, 20);
    const Vec3d down = on_plane(10, 21) - on_plane(10, 20);
    EXPECT_NEAR(length(right), length(down), 1e-13);
    EXPECT_NEAR(dot(right, down), 0, 1e-13);
    EXPECT_LT(length(on_plane(80, 5) - on_plane(79, 5) - right), 1e-12);
    EXPECT_GT(dot(cross(right, down), forward), 0);  // x right, y down, seen along the view
  }
}

TEST(Camera, RaysFoundAtOnceAreTheSame) {
  Random random(4);
  for (int i = 0; i < 200; ++i) {
    const Camera camera = random_camera(random);
    const CameraRays rays(camera, 90, 40);
    const double x = random.uniform(0, 90), y = random.uniform(0, 40);
    EXPECT_EQ(rays.direction(x, y), camera.ray_direction(x, y, 90, 40));
    EXPECT_NO_THROW(check_camera(camera, "camera"));
  }
}

TEST(Camera, ThoseWithoutRaysAreRefusedByTheField) {
  const auto where = [](const auto& change) {
    Camera camera;
    change(camera);
    const std::string error = test::error_of([&] { check_camera(camera, "view"); });
    return error.substr(0, error.find(':'));
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(where([](Camera& c) { c.position.x = kNan; }), "view/position");
  EXPECT_EQ(where([](Camera& c) { c.target.y = 1e10; }), "view/target");
  EXPECT_EQ(where([](Camera& c) { c.target = c.position; }), "view/target");
  EXPECT_EQ(where([](Camera& c) { c.up = {0, 0, 0}; }), "view/up");
  EXPECT_EQ(where([](Camera& c) { c.up = {0, 0, -2}; }), "view/up");
  EXPECT_EQ(where([](Camera& c) { c.up.z = kNan; }), "view/up");
  for (const double angle : {0.5, 171.0, kNan}) {
    EXPECT_EQ(where([angle](Camera& c) { c.vertical_field_of_view_degrees = angle; }),
              "view/field_of_view");
  }
}

}  // namespace
}  // namespace rimlight
