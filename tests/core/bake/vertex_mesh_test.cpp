#include "core/bake/vertex_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "core/math/random.h"
#include "tests/core/bake/bake_scenes.h"
#include "tests/core/scene/scene_cases.h"
#include "tests/support/error_of.h"

namespace rimlight {
namespace {

double area(const VertexMesh& mesh) {
  const std::vector<double> areas = vertex_areas(mesh);
  return std::accumulate(areas.begin(), areas.end(), 0.0);
}

Material varnish() {
  Material material = lambert(0.5f);
  material.brdf.model = BrdfModel::phong;
  material.brdf.specular = {0.1f, 0.2f, 0.3f};
  return material;
}

TEST(VertexMesh, DropsWhatNothingUsesAndCountsIt) {
  Mesh mesh = quad({0, 0, 0}, {2, 0, 0}, {0, 0, 3}, 0);
  mesh.positions.push_back({9, 9, 9});  // of no triangle
  mesh.positions.push_back({1, 0, 0});  // on the first side: a triangle without area
  mesh.triangles.push_back({0, 5, 1});
  mesh.triangles.push_back({2, 2, 3});
  const PreparedVertices prepared = prepare_vertices(*scene_of({mesh}));
  EXPECT_EQ(prepared.dropped_triangles, 2u);
  EXPECT_EQ(prepared.unused_vertices, 2u);
  EXPECT_EQ(prepared.mesh.positions.size(), 4u);
  EXPECT_EQ(prepared.mesh.triangles.size(), 2u);
  EXPECT_EQ(prepared.computed_normals, 4u);
  EXPECT_NEAR(area(prepared.mesh), 6, 1e-6);
  mesh.triangles = {{2, 2, 3}};
  EXPECT_THAT(test::error_of([&] { prepare_vertices(*scene_of({mesh})); }),
              testing::HasSubstr("no triangles"));
}

TEST(VertexMesh, EqualVerticesAreJoinedButNotAcrossMaterials) {
  auto scene = scene_of({triangle_soup(1, 1)});
  scene->materials.push_back(lambert(0.2f));
  Mesh corners;  // a quad as two triangles that share no vertex
  add_triangle(corners, {0, 0, 0}, {1, 0, 0}, {1, 0, 1});
  add_triangle(corners, {0, 0, 0}, {1, 0, 1}, {0, 0, 1});
  Mesh other = corners;
  other.material = 1;
  scene->meshes = {corners};
  const PreparedVertices one = prepare_vertices(*scene);
  EXPECT_EQ(one.mesh.positions.size(), 4u);
  EXPECT_EQ(one.joined_vertices, 2u);
  scene->meshes = {corners, other};
  const PreparedVertices two = prepare_vertices(*scene);
  EXPECT_EQ(two.mesh.positions.size(), 8u);
  for (const auto& t : two.mesh.triangles) {
    EXPECT_EQ(two.mesh.materials[t[0]], two.mesh.materials[t[1]]);
    EXPECT_EQ(two.mesh.materials[t[0]], two.mesh.materials[t[2]]);
  }
}

TEST(VertexMesh, MissingNormalsAreComputedAndOwnOnesKept) {
  Mesh sphere = test_sphere({1, 2, 3}, 2, 12);
  const PreparedVertices computed = prepare_vertices(*scene_of({sphere}));
  EXPECT_EQ(computed.computed_normals, computed.mesh.positions.size());
  ASSERT_GT(computed.mesh.positions.size(), 200u);
  for (std::size_t i = 0; i < computed.mesh.positions.size(); ++i) {
    const Vec3d outward = normalized(Vec3d(computed.mesh.positions[i]) - Vec3d(1, 2, 3));
    EXPECT_GT(std::abs(dot(outward, Vec3d(computed.mesh.normals[i]))), 0.995);
    EXPECT_NEAR(length(computed.mesh.normals[i]), 1, 1e-6);
  }
  sphere.normals.assign(sphere.positions.size(), {0, 3, 0});
  sphere.normals[40] = {};  // none after all
  const PreparedVertices own = prepare_vertices(*scene_of({sphere}));
  EXPECT_EQ(own.computed_normals, 1u);
  EXPECT_EQ(std::ranges::count(own.mesh.normals, Vec3f(0, 1, 0)),
            static_cast<std::ptrdiff_t>(own.mesh.positions.size()) - 1);
}

TEST(VertexMesh, NormalsThatCancelOutAreATriangles) {
  Mesh mesh;  // two sides of one triangle
  add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  add_triangle(mesh, {0, 0, 0}, {0, 1, 0}, {1, 0, 0});
  const PreparedVertices prepared = prepare_vertices(*scene_of({mesh}));
  ASSERT_FALSE(prepared.mesh.normals.empty());
  for (const Vec3f& normal : prepared.mesh.normals) EXPECT_EQ(std::abs(normal.z), 1);
}

TEST(VertexMesh, VerticesWithAHighlightComeFirst) {
  auto scene = scene_of({});
  scene->materials = {lambert(0.5f), varnish()};
  for (std::uint32_t material : {0u, 1u, 0u, 1u}) {
    scene->meshes.push_back(test_sphere({static_cast<float>(scene->meshes.size()), 0, 0}, 0.4f, 6));
    scene->meshes.back().material = material;
  }
  const PreparedVertices prepared = prepare_vertices(*scene);
  EXPECT_EQ(static_cast<std::ptrdiff_t>(prepared.highlight_count),
            std::ranges::count(prepared.mesh.materials, 1u));
  EXPECT_GT(prepared.highlight_count, 100u);
  for (std::size_t i = 0; i < prepared.mesh.positions.size(); ++i) {
    EXPECT_EQ(prepared.mesh.materials[i], i < prepared.highlight_count ? 1u : 0u);
  }
}

TEST(VertexMesh, BatchesAreCompactAndTrianglesStayTheSame) {
  Mesh sphere = test_sphere({0, 0, 0}, 1, 48);
  Random random(3);  // in random order
  std::vector<std::uint32_t> place(sphere.positions.size());
  std::iota(place.begin(), place.end(), 0u);
  for (std::size_t i = place.size() - 1; i > 0; --i)
    std::swap(place[i], place[random.below(i + 1)]);
  Mesh shuffled = sphere;
  for (std::size_t i = 0; i < place.size(); ++i) shuffled.positions[place[i]] = sphere.positions[i];
  for (auto& t : shuffled.triangles) t = {place[t[0]], place[t[1]], place[t[2]]};
  const PreparedVertices prepared = prepare_vertices(*scene_of({shuffled}));
  const auto corners = [](const auto& mesh) {
    std::multiset<std::array<float, 9>> result;
    for (const auto& t : mesh.triangles) {
      const Vec3f &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
      // + 0: no sign on a zero.
      result.insert(
          {a.x + 0, a.y + 0, a.z + 0, b.x + 0, b.y + 0, b.z + 0, c.x + 0, c.y + 0, c.z + 0});
    }
    return result;
  };
  EXPECT_EQ(corners(prepared.mesh), corners(shuffled));
  double mean = 0;  // distance of a batch's vertices from their middle; 1 in random order
  const std::size_t count = prepared.mesh.positions.size();
  for (std::size_t first = 0; first < count; first += kBatchVertices) {
    const std::size_t last = std::min(count, first + kBatchVertices);
    Vec3d middle;
    for (std::size_t i = first; i < last; ++i) middle += Vec3d(prepared.mesh.positions[i]);
    middle = middle / static_cast<double>(last - first);
    for (std::size_t i = first; i < last; ++i) {
      mean += length(Vec3d(prepared.mesh.positions[i]) - middle) / static_cast<double>(count);
    }
  }
  EXPECT_LT(mean, 0.3);
}

TEST(VertexMesh, TexturesAreLookedUpAtVertices) {
  auto picture = std::make_shared<RgbImage>(2, 1);
  picture->pixels = {{1, 0, 0}, {0, 0.5f, 1}};
  auto scene = scene_of({quad({0, 0, 0}, {1, 0, 0}, {0, 0, 1}, 0)});
  scene->materials[0].albedo_texture = picture;
  scene->meshes[0].texture_coordinates = {{0.25f, 0}, {0.75f, 0}, {0.75f, 1}, {0.25f, 1}};
  const PreparedVertices prepared = prepare_vertices(*scene);
  ASSERT_EQ(prepared.mesh.tints.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    const bool left = prepared.mesh.positions[i].x == 0;
    EXPECT_EQ(prepared.mesh.tints[i], left ? Vec3f(1, 0, 0) : Vec3f(0, 0.5f, 1));
  }
}

}  // namespace
}  // namespace rimlight
