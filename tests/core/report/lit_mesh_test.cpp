// Transport and views of a mesh by itself, on a ball, where both are known.
#include "core/report/lit_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/scene/shapes.h"

namespace rimlight {
namespace {

float coefficient(std::span<const Half> transport, int degree, std::size_t vertex, std::size_t i) {
  const std::size_t batch = vertex / kBatchVertices * sh::coefficient_count(degree);
  return to_float(transport[(batch + i) * kBatchVertices + vertex % kBatchVertices]);
}

TEST(LitMesh, OfABallSeesHalfTheSky) {
  const LitMesh lit = light_mesh("ball", {make_sphere(2, 24)}, 3);
  ASSERT_GT(lit.mesh.positions.size(), 100u);
  const double y0 = std::sqrt(1 / (4 * std::numbers::pi));
  for (std::size_t v = 0; v < lit.mesh.positions.size(); ++v) {
    // Of 1024 directions some lie about the horizon, above or below.
    EXPECT_NEAR(static_cast<double>(coefficient(lit.visibility, 3, v, 0)),
                2 * std::numbers::pi * y0, 0.05);
    EXPECT_NEAR(static_cast<double>(coefficient(lit.irradiance, 3, v, 0)), std::numbers::pi * y0,
                0.01);
    // The first band of a clamped cosine: 2π/3 of the normal, √(3/4π) (y, z, x).
    EXPECT_NEAR(static_cast<double>(coefficient(lit.irradiance, 3, v, 1)),
                2 * std::numbers::pi / 3 * std::sqrt(3 / (4 * std::numbers::pi)) *
                    static_cast<double>(lit.mesh.normals[v].y),
                0.01);
  }
}

TEST(LitMesh, OfLowerDegreeHasTheSameCoefficients) {
  const LitMesh lit = light_mesh("ball", {make_sphere(2, 12)}, 4);
  const LitMesh cut = lit.to_degree(2);
  for (std::size_t v = 0; v < lit.mesh.positions.size(); ++v) {
    for (std::size_t i = 0; i < sh::coefficient_count(2); ++i) {
      ASSERT_EQ(coefficient(cut.visibility, 2, v, i), coefficient(lit.visibility, 4, v, i));
      ASSERT_EQ(coefficient(cut.irradiance, 2, v, i), coefficient(lit.irradiance, 4, v, i));
    }
  }
  EXPECT_THROW(lit.to_degree(5), CheckFailure);
}

TEST(LitMesh, IsMendedWhereAFileIsNot) {
  Mesh soup;  // two triangles with corners of their own, one of no area, and a vertex of none
  soup.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {9, 9, 9}};
  soup.triangles = {{0, 1, 2}, {3, 4, 5}, {0, 0, 1}};
  const LitMesh lit = light_mesh("soup", {soup}, 1);
  EXPECT_EQ(lit.mesh.positions.size(), 4u);
  EXPECT_EQ(lit.mesh.triangles.size(), 2u);
  for (const Vec3f& normal : lit.mesh.normals) EXPECT_NEAR(normal.z, 1, 1e-6f);
  soup.triangles = {{0, 0, 1}};
  EXPECT_THROW(light_mesh("soup", {soup}, 1), Error);
}

TEST(MeshView, ShowsTheNearHalfOfABall) {
  const LitMesh lit = light_mesh("ball", {make_sphere(1, 24)}, 1);
  const MeshView view = view_mesh(lit, {0, 0, 1});
  ASSERT_EQ(view.mirrored.size(), lit.mesh.positions.size());
  const Vec3f eye(0, 0, 4);  // twice the extent from the middle
  for (std::uint32_t v = 0; v < lit.mesh.positions.size(); ++v) {
    const Vec3f &position = lit.mesh.positions[v], &normal = lit.mesh.normals[v];
    const float cosine = dot(normalized(eye - position), normal);
    const bool visible = std::ranges::binary_search(view.visible, v);
    if (std::abs(cosine) > 0.02f) {
      EXPECT_EQ(visible, cosine > 0) << v;
    }
    EXPECT_NEAR(dot(view.mirrored[v], normal), cosine, 1e-2f);
    EXPECT_NEAR(length(view.mirrored[v]), 1, 1e-5f);
  }
}

TEST(LightCoefficients, OfAUniformSkyAreOfBandZero) {
  RgbImage white;
  white.width = 8;
  white.height = 4;
  white.pixels.assign(32, Vec3f{1, 2, 3});
  const auto light = light_coefficients(Environment("white", white), 2);
  ASSERT_EQ(light.size(), 27u);
  for (std::size_t k = 0; k < light.size(); ++k) {
    const double truth =
        k % 9 == 0 ? std::sqrt(4 * std::numbers::pi) * static_cast<double>(k / 9 + 1) : 0;
    EXPECT_NEAR(static_cast<double>(light[k]), truth, 1e-3) << k;
  }
}

}  // namespace
}  // namespace rimlight
