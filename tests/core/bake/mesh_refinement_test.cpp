#include "core/bake/mesh_refinement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/bake/vertex_mesh.h"
#include "core/math/random.h"
#include "core/scene/mesh_geometry.h"
#include "tests/core/bake/bake_scenes.h"
#include "tests/core/scene/scene_cases.h"
#include "tests/support/error_of.h"

namespace rimlight {
namespace {

constexpr std::size_t kMany = 1 << 20;

using Point = std::array<float, 3>;

Point point_of(const Mesh& mesh, std::uint32_t i) {
  const Vec3f& p = mesh.positions[i];
  return {p.x + 0, p.y + 0, p.z + 0};
}

/// With normals, as refine() asks for.
Mesh with_normals(Mesh mesh) {
  smooth_normals(mesh);
  return mesh;
}

/// Closed, with edges of many lengths, and each face with vertices of its own.
Mesh octahedron(const Vec3f& size) {
  Mesh mesh;
  for (const float x : {-1.0f, 1.0f}) {
    for (const float y : {-1.0f, 1.0f}) {
      for (const float z : {-1.0f, 1.0f}) {
        const Vec3f a(x * size.x, 0, 0), b(0, y * size.y, 0), c(0, 0, z * size.z);
        if (x * y * z > 0) {
          add_triangle(mesh, a, b, c);
        } else {
          add_triangle(mesh, a, c, b);
        }
      }
    }
  }
  return with_normals(std::move(mesh));
}

double area_of_triangles(const Mesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3d a(mesh.positions[t[0]]);
    area += length(cross(Vec3d(mesh.positions[t[1]]) - a, Vec3d(mesh.positions[t[2]]) - a)) / 2;
  }
  return area;
}

double longest_edge_of(const Mesh& mesh) {
  double longest = 0;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      longest = std::max(
          longest, length(Vec3d(mesh.positions[t[k]]) - Vec3d(mesh.positions[t[(k + 1) % 3]])));
    }
  }
  return longest;
}

/// How often triangles go along each edge, from one position to another.
std::map<std::pair<Point, Point>, int> directed_edges(const Mesh& mesh) {
  std::map<std::pair<Point, Point>, int> edges;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      ++edges[{point_of(mesh, t[k]), point_of(mesh, t[(k + 1) % 3])}];
    }
  }
  return edges;
}

/// Vertices that lie on an edge without being one of its ends, by trying all.
int t_junctions(const std::vector<Mesh>& meshes) {
  std::set<Point> points;
  std::set<std::pair<Point, Point>> edges;
  for (const Mesh& mesh : meshes) {
    for (std::uint32_t i = 0; i < mesh.positions.size(); ++i) points.insert(point_of(mesh, i));
    for (const auto& [edge, count] : directed_edges(mesh)) edges.insert(edge);
  }
  int found = 0;
  for (const auto& [from, to] : edges) {
    const Vec3d a(from[0], from[1], from[2]), along = Vec3d(to[0], to[1], to[2]) - a;
    for (const Point& p : points) {
      const Vec3d offset = Vec3d(p[0], p[1], p[2]) - a;
      const double share = dot(offset, along) / dot(along, along);
      if (!(share > 1e-3 && share < 1 - 1e-3)) continue;
      if (length(offset - along * share) < 1e-5 * length(along)) ++found;
    }
  }
  return found;
}

TEST(MeshRefinement, KeepsAreaAndBoxAndMakesEveryEdgeShort) {
  Random random(5);
  for (int run = 0; run < 40; ++run) {
    Mesh mesh = with_normals(triangle_soup(20, static_cast<std::uint64_t>(run + 1)));
    const Mesh before = mesh;
    const double longest = longest_edge_of(mesh) * random.uniform(0.05, 0.9);
    ASSERT_TRUE(refine(mesh, longest, kMany));
    EXPECT_LE(longest_edge_of(mesh), longest);
    EXPECT_GT(mesh.triangles.size(), before.triangles.size());
    EXPECT_NEAR(area_of_triangles(mesh), area_of_triangles(before),
                1e-5 * area_of_triangles(before));
    const Bounds a = bounds_of({&mesh, 1}), b = bounds_of({&before, 1});
    EXPECT_EQ(a.low, b.low);
    EXPECT_EQ(a.high, b.high);
    EXPECT_TRUE(
        std::equal(before.positions.begin(), before.positions.end(), mesh.positions.begin()));
    EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
  }
}

TEST(MeshRefinement, ShortEdgesStayAsTheyAre) {
  Mesh mesh = octahedron({1, 2, 3});
  const Mesh before = mesh;
  ASSERT_TRUE(refine(mesh, longest_edge_of(mesh) * (1 + 1e-9), 0));
  EXPECT_EQ(mesh.triangles, before.triangles);
  EXPECT_EQ(mesh.positions, before.positions);
}

TEST(MeshRefinement, WhatIsClosedStaysClosedAndKeepsItsOrientation) {
  for (const double longest : {1.0, 0.4, 0.15}) {
    Mesh mesh = octahedron({3, 0.3f, 1});
    ASSERT_TRUE(refine(mesh, longest, kMany));
    const auto edges = directed_edges(mesh);
    ASSERT_GT(edges.size(), 24u);
    for (const auto& [edge, count] : edges) {
      EXPECT_EQ(count, 1);
      EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
    }
    for (const auto& t : mesh.triangles) {  // seen from outside, still
      const Vec3d a(mesh.positions[t[0]]);
      const Vec3d across = cross(Vec3d(mesh.positions[t[1]]) - a, Vec3d(mesh.positions[t[2]]) - a);
      EXPECT_GT(dot(across, a) * dot(Vec3d(mesh.normals[t[0]]), a), 0);
    }
  }
}

TEST(MeshRefinement, MakesNoTJunctionsNorBetweenMeshes) {
  // Two quads of different sides and diagonals meet along an edge; an octahedron joins itself.
  std::vector<Mesh> meshes = {with_normals(quad({0, 0, 0}, {1, 0, 0}, {0, 0, 2.7f}, 0)),
                              with_normals(quad({0, 0, 2.7f}, {0, 0, -2.7f}, {0, 0.4f, 0}, 1)),
                              octahedron({2, 0.5f, 1})};
  for (Vec3f& p : meshes[2].positions) p.x += 8;  // apart
  for (Mesh& mesh : meshes) ASSERT_TRUE(refine(mesh, 0.21, kMany));
  EXPECT_EQ(t_junctions(meshes), 0);
  meshes[0] = with_normals(quad({0, 0, 0}, {1, 0, 0}, {0, 0, 2.7f}, 0));
  ASSERT_TRUE(refine(meshes[0], 0.5, kMany));
  EXPECT_GT(t_junctions(meshes), 0);  // the search finds them where there are some
}

TEST(MeshRefinement, NeedlesComeToAnEnd) {
  for (const float height : {1e-2f, 1e-4f, 1e-6f}) {
    for (const float foot : {0.0f, 0.3f, 0.5f, 0.999f}) {
      Mesh mesh;
      add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {foot, height, 0});
      mesh.normals.assign(3, {0, 0, 1});
      ASSERT_TRUE(refine(mesh, 0.01, kMany));
      EXPECT_LE(longest_edge_of(mesh), 0.01);
      EXPECT_LE(mesh.positions.size(), 8385u) << height << " " << foot;  // equilateral: 128 rows
    }
  }
}

TEST(MeshRefinement, EndsWhereNoFloatLiesBetween) {
  Mesh mesh;
  add_triangle(mesh, {1e6f, 0, 0}, {1e6f + 1, 0, 0}, {1e6f, 0, 1});
  mesh.normals.assign(3, {0, 1, 0});
  mesh.positions[2].z = 0.0625f;
  ASSERT_TRUE(refine(mesh, 0.01, 1 << 16));
  EXPECT_GT(mesh.positions.size(), 17u);
  EXPECT_LE(longest_edge_of(mesh), 0.0884);  // √2/16: floats are a 16th apart
}

TEST(MeshRefinement, NormalsAreUnitAndBetweenThoseOfTheEnds) {
  Mesh mesh = quad({0, 0, 0}, {1, 0, 0}, {0, 0, 1}, 0);
  mesh.normals = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, 0.6f, 0.8f}};
  ASSERT_TRUE(refine(mesh, 0.1, kMany));
  ASSERT_GT(mesh.normals.size(), 100u);
  for (const Vec3f& normal : mesh.normals) EXPECT_NEAR(length(normal), 1, 1e-6);
  const auto middle = std::ranges::find(mesh.positions, Vec3f(0.5f, 0, 0));
  ASSERT_NE(middle, mesh.positions.end());
  const Vec3f& between = mesh.normals[static_cast<std::size_t>(middle - mesh.positions.begin())];
  EXPECT_NEAR(between.x, std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(between.y, std::sqrt(0.5), 1e-6);
}

TEST(MeshRefinement, TheCapIsKept) {
  Mesh mesh = octahedron({1, 1, 1});
  EXPECT_FALSE(refine(mesh, 1e-3, 5000));
  EXPECT_LE(mesh.positions.size(), 24u + 5000 + 3);
  auto scene = scene_of({octahedron({1, 1, 1})});
  scene->name = "gem";
  scene->bake.vertex.longest_edge = 1e-9;
  EXPECT_THAT(test::error_of([&] { prepare_vertices(*scene); }),
              testing::AllOf(testing::HasSubstr("gem"), testing::HasSubstr("longest_edge"),
                             testing::HasSubstr("2097152")));
}

TEST(MeshRefinement, PreparedVerticesAreAShareOfTheSceneApartAndSplitFacesAreJoined) {
  auto scene = scene_of({octahedron({3, 0.3f, 1})});
  for (const double share : {0.0, 0.5, 0.04}) {
    scene->bake.vertex.longest_edge = share;
    const PreparedVertices prepared = prepare_vertices(*scene);
    const std::size_t vertices = prepared.mesh.positions.size();
    // Euler: closed and in one piece, so vertices − triangles/2 = 2.
    EXPECT_EQ(vertices, prepared.mesh.triangles.size() / 2 + 2);
    EXPECT_EQ(vertices + prepared.joined_vertices, 24 + prepared.added_vertices);
    Mesh mesh;
    mesh.positions = prepared.mesh.positions;
    mesh.triangles = prepared.mesh.triangles;
    EXPECT_LE(longest_edge_of(mesh), share > 0 ? 6 * share : 3.2);
    EXPECT_EQ(share == 0, vertices == 6);
  }
}

TEST(MeshRefinement, TexturesAreLookedUpAtNewVerticesNotInterpolated) {
  auto picture = std::make_shared<RgbImage>(4, 1);
  picture->pixels = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}};
  auto scene = scene_of({quad({0, 0, 0}, {1, 0, 0}, {0, 0, 1}, 0)});
  scene->materials[0].albedo_texture = picture;
  scene->meshes[0].texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  scene->bake.vertex.longest_edge = 0.13;
  const PreparedVertices prepared = prepare_vertices(*scene);
  int checked = 0;
  for (std::size_t i = 0; i < prepared.mesh.positions.size(); ++i) {
    if (prepared.mesh.positions[i].x != 0.375f) continue;  // the middle of the second pixel
    EXPECT_EQ(prepared.mesh.tints[i], Vec3f(1, 0, 0));
    ++checked;
  }
  EXPECT_GE(checked, 5);
}

}  // namespace
}  // namespace rimlight
