#include "core/scene/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/base/check.h"
#include "core/scene/mesh_geometry.h"

namespace rimlight {
namespace {

constexpr double kPi = std::numbers::pi;

struct Shape {
  std::string name;
  Mesh mesh;
};

std::vector<Shape> closed_shapes(int segments) {
  return {{"sphere", make_sphere(2, segments)},
          {"box", make_box({1, 2, 3})},
          {"torus", make_torus(2, 1, segments)},
          {"cylinder", make_cylinder(1.5, 2, segments)},
          {"cone", make_cone(1.5, 2, segments)}};
}

std::vector<Shape> all_shapes(int segments) {
  std::vector<Shape> shapes = closed_shapes(segments);
  shapes.push_back({"plane", make_plane(2, 3)});
  shapes.push_back({"disc", make_disc(2, segments)});
  return shapes;
}

Vec3d corner(const Mesh& mesh, std::size_t triangle, std::size_t k) {
  return Vec3d(mesh.positions[mesh.triangles[triangle][k]]);
}

Vec3d doubled_area(const Mesh& mesh, std::size_t t) {
  return cross(corner(mesh, t, 1) - corner(mesh, t, 0), corner(mesh, t, 2) - corner(mesh, t, 0));
}

/// Signed: positive when the triangles turn outward.
double volume(const Mesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    sum += dot(corner(mesh, t, 0), cross(corner(mesh, t, 1), corner(mesh, t, 2))) / 6;
  }
  return sum;
}

double area(const Mesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) sum += length(doubled_area(mesh, t)) / 2;
  return sum;
}

TEST(Shapes, HaveTheVolumeAndAreaOfTheirNames) {
  constexpr int kSegments = 512;
  // Polygons inscribed in circles: relative errors of about (π / segments)² each way.
  constexpr double kError = 4 * (kPi / kSegments) * (kPi / kSegments) * 4;
  const std::map<std::string, std::pair<double, double>> expected{
      {"sphere", {4.0 / 3 * kPi * 8, 16 * kPi}},
      {"box", {6, 22}},
      {"torus", {2 * kPi * kPi * 2 * 0.25, 4 * kPi * kPi * 2 * 0.5}},
      {"cylinder", {kPi * 2.25 * 2, 2 * kPi * 1.5 * (1.5 + 2)}},
      {"cone", {kPi * 2.25 * 2 / 3, kPi * 1.5 * (1.5 + 2.5)}},
      {"plane", {0, 6}},
      {"disc", {0, 4 * kPi}}};
  int compared = 0;
  for (const Shape& shape : all_shapes(kSegments)) {
    const auto& [want_volume, want_area] = expected.at(shape.name);
    EXPECT_NEAR(area(shape.mesh), want_area, kError * want_area + 1e-5) << shape.name;
    EXPECT_NEAR(volume(shape.mesh), want_volume, kError * want_volume + 1e-5) << shape.name;
    ++compared;
  }
  EXPECT_EQ(compared, 7);
}

TEST(Shapes, EveryTriangleTurnsTheWayItsNormalsPoint) {
  for (const int segments : {3, 4, 5, 64}) {
    for (const Shape& shape : all_shapes(segments)) {
      ASSERT_EQ(shape.mesh.normals.size(), shape.mesh.positions.size());
      ASSERT_EQ(shape.mesh.texture_coordinates.size(), shape.mesh.positions.size());
      for (std::size_t t = 0; t < shape.mesh.triangles.size(); ++t) {
        const Vec3d normal = doubled_area(shape.mesh, t);
        for (const std::uint32_t vertex : shape.mesh.triangles[t]) {
          ASSERT_NEAR(length(shape.mesh.normals[vertex]), 1, 1e-5) << shape.name;
          ASSERT_GT(dot(normal, Vec3d(shape.mesh.normals[vertex])), 0)
              << shape.name << " of " << segments;
        }
      }
    }
  }
}

TEST(Shapes, AreClosedAndHaveNoDegenerateTriangles) {
  for (const int segments : {3, 64}) {
    for (Shape& shape : closed_shapes(segments)) {
      EXPECT_EQ(drop_degenerate_triangles(shape.mesh), 0u) << shape.name;
      // By position: each directed edge once, and its opposite once.
      std::map<std::vector<float>, int> edges;
      for (const auto& t : shape.mesh.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
          const Vec3f& a = shape.mesh.positions[t[k]];
          const Vec3f& b = shape.mesh.positions[t[(k + 1) % 3]];
          ++edges[{a.x, a.y, a.z, b.x, b.y, b.z}];
        }
      }
      ASSERT_GT(edges.size(), 10u);
      for (const auto& [edge, count] : edges) {
        ASSERT_EQ(count, 1) << shape.name;
        const std::vector<float> back{edge[3], edge[4], edge[5], edge[0], edge[1], edge[2]};
        ASSERT_EQ(edges.count(back), 1u) << shape.name << " of " << segments;
      }
    }
  }
}

TEST(Shapes, StandWhereTheHeaderSays) {
  const auto bounds = [](Mesh mesh) { return bounds_of(std::vector<Mesh>{std::move(mesh)}); };
  EXPECT_NEAR(bounds(make_sphere(2, 64)).low.y, -2, 1e-6);
  EXPECT_NEAR(bounds(make_box({1, 2, 3})).high.z, 1.5, 1e-6);
  EXPECT_EQ(bounds(make_cylinder(1, 2, 16)).low.y, 0);
  EXPECT_EQ(bounds(make_cone(1, 2, 16)).high.y, 2);
  EXPECT_NEAR(bounds(make_torus(2, 1, 64)).high.x, 2.5, 1e-6);
  EXPECT_EQ(bounds(make_disc(1, 16)).high.y, 0);
}

TEST(Shapes, ALatheNeedsAProfileAndThreeSegments) {
  const ProfilePoint line[] = {{1, 0}, {1, 1}};
  EXPECT_THROW(lathe(line, 2), CheckFailure);
  const ProfilePoint point[] = {{1, 0}, {1, 0}};
  EXPECT_THROW(lathe(point, 8), CheckFailure);
  EXPECT_EQ(lathe(line, 8).triangles.size(), 16u);
}

}  // namespace
}  // namespace rimlight
