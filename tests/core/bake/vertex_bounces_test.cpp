// Light between vertices: closed forms, energy, and a dense solution in double.
#include "core/bake/vertex_bounces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/bake/vertex_mesh.h"
#include "core/bake/vertex_visibility.h"
#include "core/base/parallel.h"
#include "core/basis/sh.h"
#include "core/math/random.h"
#include "tests/core/bake/bake_scenes.h"
#include "tests/core/scene/scene_cases.h"

namespace rimlight {
namespace {

constexpr double kPi = std::numbers::pi;

/// A hollow ball, lit through a hole in its top. Its vertices look inside.
struct Cavity {
  PreparedVertices prepared;
  double open = 0;  // share of the ball's surface
};

Cavity make_cavity(double hole_height) {
  Mesh ball = test_sphere({0, 0, 0}, 1, 24);
  for (const Vec3f& p : ball.positions) ball.normals.push_back(-p);
  const auto area_of = [](const Mesh& mesh) {
    double sum = 0;
    for (const auto& t : mesh.triangles) {
      const Vec3d a(mesh.positions[t[0]]);
      sum += length(cross(Vec3d(mesh.positions[t[1]]) - a, Vec3d(mesh.positions[t[2]]) - a)) / 2;
    }
    return sum;
  };
  const double whole = area_of(ball);
  std::erase_if(ball.triangles, [&](const auto& t) {
    return std::ranges::all_of(t, [&](auto i) { return ball.positions[i].y > hole_height; });
  });
  return {prepare_vertices(*scene_of({ball})), 1 - area_of(ball) / whole};
}

/// Irradiance of each vertex under a uniform sky of radiance 1.
std::vector<double> under_even_light(const std::vector<float>& values, std::size_t coefficients) {
  std::vector<double> result;
  for (std::size_t i = 0; i < values.size(); i += coefficients) {
    result.push_back(values[i] * std::sqrt(4 * kPi));
  }
  return result;
}

/// Direct light and what vertices see of each other, to degree 2.
struct Traced {
  std::vector<float> direct;
  GatherMatrix matrix;
};

Traced trace(const PreparedVertices& prepared, double error) {
  const RayScene rays = ray_scene_of(prepared.mesh);
  const RaySettings settings{.degree = 2, .error = error, .most_rays = 1 << 14, .seed = 1};
  VertexVisibility direct =
      shadowed_visibility(rays, prepared.mesh, prepared.highlight_count, settings, {});
  const std::vector<float> albedos(prepared.mesh.positions.size(), 0.99f);
  Gathered gathered =
      gather(rays, prepared.mesh, direct.blocked, albedos, direct.irradiance, settings, {});
  return {std::move(direct.irradiance), std::move(gathered.matrix)};
}

std::vector<double> all_light(const PreparedVertices& prepared, const Traced& traced,
                              float albedo) {
  const std::vector<Material> materials(1);
  const SubsurfaceSpread spread(prepared.mesh, materials);
  const std::vector<float> albedos(prepared.mesh.positions.size(), albedo);
  std::vector<float> light = traced.direct;
  const Bounces bounces = add_bounces(traced.matrix, albedos, spread, 0, 9, 1e-3, light);
  EXPECT_LE(bounces.left, 1e-3);
  EXPECT_GT(bounces.count, 2);
  return under_even_light(light, 9);
}

/// From any point of a ball's inside, any part of it fills the same share of the cosine-weighted
/// view. So E = π f + (1 − f) ρ E everywhere, f the hole's share.
TEST(VertexBounces, AHollowBallHasTheClosedFormsIrradiance) {
  const Cavity cavity = make_cavity(0.7);
  ASSERT_GT(cavity.open, 0.1);
  ASSERT_LT(cavity.open, 0.2);
  const Traced traced = trace(cavity.prepared, 0.004);
  for (const float albedo : {0.3f, 0.8f, 0.99f}) {
    const std::vector<double> light = all_light(cavity.prepared, traced, albedo);
    const double expected = kPi * cavity.open / (1 - albedo * (1 - cavity.open));
    double sum = 0, worst = 0;
    for (const double e : light) {
      sum += e;
      worst = std::max(worst, std::abs(e / expected - 1));
    }
    // The ball has flat faces, and the lip's vertices stand on its rim.
    EXPECT_NEAR(sum / static_cast<double>(light.size()) / expected, 1, 0.015) << albedo;
    EXPECT_LT(worst, 0.08) << albedo;
  }
}

TEST(VertexBounces, NoVertexGetsMoreThanTheSkyWouldGive) {
  const auto scene = corner_scene(lambert(1));
  scene->bake.vertex.longest_edge = 0;
  const PreparedVertices prepared = prepare_vertices(*scene);
  const auto light = all_light(prepared, trace(prepared, 0.005), 0.99f);
  const double largest = *std::max_element(light.begin(), light.end());
  EXPECT_LT(largest, kPi * 1.01);
  EXPECT_GT(largest, kPi * 0.5);
}

TEST(VertexBounces, RowsOfTheMatrixAreSharesOfTheView) {
  const Cavity cavity = make_cavity(0.7);
  const VertexMesh& mesh = cavity.prepared.mesh;
  const RayScene rays = ray_scene_of(mesh);
  const std::size_t vertices = mesh.positions.size();
  const std::vector<std::uint32_t> blocked(vertices, 1);
  const std::vector<float> albedo(vertices, 0.5f), light(vertices, 0.5f);
  const RaySettings settings{.degree = 0, .error = 0.01, .most_rays = 4096, .seed = 1};
  const Gathered gathered = gather(rays, mesh, blocked, albedo, light, settings, {});
  double sum = 0;
  ASSERT_EQ(gathered.matrix.rows(), vertices);
  for (std::size_t row = 0; row < vertices; ++row) {
    EXPECT_LE(gathered.matrix.row_sum(row), 1 + 1e-5);
    sum += gathered.matrix.row_sum(row);
    for (std::uint64_t i = gathered.matrix.first[row] + 1; i < gathered.matrix.first[row + 1];
         ++i) {
      ASSERT_LT(gathered.matrix.column[i - 1], gathered.matrix.column[i]);
    }
  }
  EXPECT_NEAR(sum / static_cast<double>(vertices), 1 - cavity.open, 0.01);
  set_thread_count(1);
  const Gathered again = gather(rays, mesh, blocked, albedo, light, settings, {});
  set_thread_count(0);
  EXPECT_EQ(gathered.matrix.weight, again.matrix.weight);
  EXPECT_EQ(gathered.matrix.column, again.matrix.column);
}

TEST(VertexBounces, BacksAreBlack) {
  // A lid over a floor, both looking up: the floor sees the lid's back only.
  Mesh floor = quad({-1, 0, -1}, {2, 0, 0}, {0, 0, 2}, 0);
  floor.normals.assign(4, {0, 1, 0});
  Mesh lid = quad({-9, 0.5f, -9}, {18, 0, 0}, {0, 0, 18}, 0);
  lid.normals.assign(4, {0, 1, 0});
  const PreparedVertices prepared = prepare_vertices(*scene_of({floor, lid}));
  const RayScene rays = ray_scene_of(prepared.mesh);
  const std::vector<std::uint32_t> blocked(8, 1);
  const std::vector<float> ones(8, 1);
  const auto matrix =
      gather(rays, prepared.mesh, blocked, ones, ones, {.degree = 0, .error = 0.1}, {}).matrix;
  for (std::size_t row = 0; row < 8; ++row) EXPECT_EQ(matrix.row_sum(row), 0);
}

/// Gaussian elimination with the largest pivot.
std::vector<double> solve(std::vector<std::vector<double>> a, std::vector<double> b) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t best = k;
    for (std::size_t i = k; i < n; ++i) best = std::abs(a[i][k]) > std::abs(a[best][k]) ? i : best;
    std::swap(a[k], a[best]);
    std::swap(b[k], b[best]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = a[i][k] / a[k][k];
      for (std::size_t j = k; j < n; ++j) a[i][j] -= factor * a[k][j];
      b[i] -= factor * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) b[k] -= a[k][j] * b[j];
    b[k] /= a[k][k];
  }
  return b;
}

TEST(VertexBounces, TheSeriesIsTheSolutionOfItsEquations) {
  constexpr std::size_t kCount = 30, kCoefficients = 4;
  Random random(4);
  GatherMatrix matrix{{0}, {}, {}};
  std::vector<std::vector<double>> dense(kCount, std::vector<double>(kCount));
  std::vector<float> albedo(kCount), light(kCount * kCoefficients);
  for (float& a : albedo) a = static_cast<float>(random.uniform(0.2, 0.95));
  for (float& value : light) value = static_cast<float>(random.uniform(-1, 1));
  for (std::size_t row = 0; row < kCount; ++row) {
    for (std::size_t column = 0; column < kCount; ++column) {
      dense[row][column] = row == column ? 1 : 0;
      if ((row + column) % 3 != 0) continue;
      matrix.column.push_back(static_cast<std::uint32_t>(column));
      matrix.weight.push_back(static_cast<float>(random.uniform(0, 0.19)));
      dense[row][column] -= static_cast<double>(matrix.weight.back()) * albedo[column];
    }
    matrix.first.push_back(matrix.column.size());
  }
  VertexMesh mesh;
  mesh.positions.resize(kCount);
  mesh.materials.resize(kCount);
  const std::vector<Material> materials(1);
  std::vector<float> found = light;
  const Bounces bounces =
      add_bounces(matrix, albedo, SubsurfaceSpread(mesh, materials), 0, kCoefficients, 1e-7, found);
  EXPECT_GT(bounces.count, 10);
  for (std::size_t c = 0; c < kCoefficients; ++c) {
    std::vector<double> right;
    for (std::size_t i = 0; i < kCount; ++i) right.push_back(light[i * kCoefficients + c]);
    const std::vector<double> expected = solve(dense, right);
    for (std::size_t i = 0; i < kCount; ++i) {
      EXPECT_NEAR(found[i * kCoefficients + c], expected[i], 1e-5);
    }
  }
}

TEST(VertexBounces, WhatIsPassedOnHasALimit) {
  VertexMesh mesh;
  mesh.tints = {{1, 0.5f, 1}, {1, 1, 1}};
  mesh.positions.resize(2);
  mesh.materials = {0, 1};
  const std::vector<VertexMaterial> materials = {{"a", {0.6f, 0.6f, 0.2f}, {0.1f, 0.2f, 0.3f}, 9},
                                                 {"b", {1, 0.9f, 0.8f}, {0, 0.1f, 0}, 9}};
  const auto found = bounced_albedo(mesh, materials);
  EXPECT_EQ(found[0], Vec3f(0.6f + 0.1f, 0.3f + 0.2f, 0.2f + 0.3f));
  EXPECT_EQ(found[1], Vec3f(kMostBouncedAlbedo, kMostBouncedAlbedo, 0.8f));
}

}  // namespace
}  // namespace rimlight
