#include "core/scene/mesh_geometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/math/random.h"
#include "core/math/sampling.h"
#include "core/scene/shapes.h"
#include "core/scene/transform.h"
#include "tests/core/scene/scene_cases.h"

namespace rimlight {
namespace {

TEST(MeshGeometry, DropsExactlyTheDegenerateTriangles) {
  Mesh mesh;
  add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});         // fine
  add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0.5f, 1e-5f, 0});  // thin, but told apart by floats
  add_triangle(mesh, {1, 1, 1}, {2, 2, 2}, {3, 3, 3});         // on a line
  add_triangle(mesh, {1, 1, 1}, {1, 1, 1}, {1, 1, 1});         // a point
  add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0.5f, 1e-9f, 0});  // height 1e-9 of its side
  mesh.triangles.push_back({0, 1, 1});
  EXPECT_EQ(drop_degenerate_triangles(mesh), 4u);
  EXPECT_EQ(mesh.triangles.size(), 2u);
}

TEST(MeshGeometry, SmallTrianglesAreNotDegenerate) {
  Mesh mesh;
  add_triangle(mesh, {0, 0, 0}, {1e-12f, 0, 0}, {0, 1e-12f, 0});
  EXPECT_EQ(drop_degenerate_triangles(mesh), 0u);
}

TEST(MeshGeometry, SmoothNormalsOfASphereAreItsOwn) {
  // The sphere's poles and seam are double vertices, which smoothing has to join.
  Mesh sphere = make_sphere(3, 96);
  const std::vector<Vec3f> truth = sphere.normals;
  smooth_normals(sphere);
  // A vertex's mean of facet normals is symmetric about its own but for rows of unequal size.
  for (std::size_t i = 0; i < truth.size(); ++i) {
    ASSERT_LT(length(sphere.normals[i] - truth[i]), 2e-3f) << i;
  }
}

TEST(MeshGeometry, SmoothNormalsOfACubeAreItsDiagonals) {
  Mesh cube = make_box({2, 2, 2});  // two triangles at some corners, one at others: angles decide
  smooth_normals(cube);
  for (std::size_t i = 0; i < cube.positions.size(); ++i) {
    ASSERT_LT(length(cube.normals[i] - normalized(cube.positions[i])), 1e-6f);
  }
}

TEST(MeshGeometry, BoundsLeaveOutVerticesThatNothingUses) {
  Mesh mesh;
  add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0, 2, -3});
  mesh.positions.push_back({100, 100, 100});
  const Bounds bounds = bounds_of(std::vector<Mesh>{mesh});
  EXPECT_EQ(bounds.low, Vec3d(0, 0, -3));
  EXPECT_EQ(bounds.high, Vec3d(1, 2, 0));
}

TEST(Transform, ComposesAndKeepsNormalsPerpendicular) {
  Random random(41);
  for (int i = 0; i < 200; ++i) {
    const Transform a = rotation(random_rotation(random)) *
                        scaling({random.uniform(0.1, 3), random.uniform(0.1, 3), -1.5}) *
                        translation(uniform_sphere(random_sample(random)));
    const Transform b = translation({1, 2, 3}) * rotation(random_rotation(random));
    const Vec3d p = uniform_sphere(random_sample(random));
    ASSERT_LT(length((a * b).point(p) - a.point(b.point(p))), 1e-12);
    const Vec3d n = uniform_sphere(random_sample(random));
    const Vec3d tangent = cross(n, p);
    ASSERT_NEAR(dot(a.linear * tangent, a.normal(n)), 0, 1e-12);
  }
}

TEST(Transform, MovesAMesh) {
  Mesh sphere = make_sphere(1, 16);
  apply(translation({5, 0, 0}) * scaling({1, 2, 1}), sphere);
  for (std::size_t i = 0; i < sphere.positions.size(); ++i) {
    const Vec3d p = Vec3d(sphere.positions[i]) - Vec3d(5, 0, 0);
    const Vec3d gradient = normalized(Vec3d(p.x, p.y / 4, p.z));
    ASSERT_LT(length(Vec3d(sphere.normals[i]) - gradient), 1e-5);
  }
}

}  // namespace
}  // namespace rimlight
