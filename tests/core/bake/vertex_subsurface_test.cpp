#include "core/bake/vertex_subsurface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/bake/vertex_mesh.h"
#include "core/base/parallel.h"
#include "core/math/random.h"
#include "tests/core/scene/scene_cases.h"

namespace rimlight {
namespace {

/// A square of side 2 in `cells` × `cells`, looking up.
Mesh grid(int cells) {
  Mesh mesh;
  for (int i = 0; i <= cells; ++i) {
    for (int j = 0; j <= cells; ++j) {
      mesh.positions.push_back(Vec3f(Vec3d(2.0 * i / cells - 1, 0, 2.0 * j / cells - 1)));
      mesh.normals.push_back({0, 1, 0});
      if (i == 0 || j == 0) continue;
      const auto at = [cells](int a, int b) {
        return static_cast<std::uint32_t>(a * (cells + 1) + b);
      };
      mesh.triangles.push_back({at(i - 1, j - 1), at(i, j - 1), at(i, j)});
      mesh.triangles.push_back({at(i - 1, j - 1), at(i, j), at(i - 1, j)});
    }
  }
  return mesh;
}

std::shared_ptr<Scene> translucent(std::vector<Mesh> meshes, const Subsurface& medium) {
  auto scene = scene_of(std::move(meshes));
  scene->materials[0].subsurface = medium;
  return scene;
}

/// The sum over every pair, in double.
std::vector<double> spread_by_pairs(const VertexMesh& mesh, const DiffusionDipole& dipole,
                                    const std::vector<float>& from) {
  const std::vector<double> areas = vertex_areas(mesh);
  std::vector<double> result;
  for (std::size_t x = 0; x < from.size(); ++x) {
    double sum = 0, weights = 0;
    for (std::size_t y = 0; y < from.size(); ++y) {
      const double distance = length(Vec3d(mesh.positions[x]) - Vec3d(mesh.positions[y]));
      const double weight = x == y ? dipole.within(std::sqrt(areas[x] / std::numbers::pi))
                                   : dipole.at(distance) * areas[y];
      sum += weight * from[y];
      weights += weight;
    }
    result.push_back(sum / std::max(weights, dipole.reflectance()));
  }
  return result;
}

TEST(VertexSubsurface, IsTheSumOverAllPairs) {
  const auto scene = translucent({grid(24)}, {{0.5f, 0.5f, 0.5f}, {4, 4, 4}, 1.3f});
  const PreparedVertices prepared = prepare_vertices(*scene);
  const SubsurfaceSpread spread(prepared.mesh, scene->materials);
  ASSERT_TRUE(spread.is_needed());
  EXPECT_FALSE(spread.is_coloured());
  Random random(2);
  std::vector<float> light(prepared.mesh.positions.size());
  for (float& value : light) value = random.uniform_float();
  const auto expected =
      spread_by_pairs(prepared.mesh, dipole_of(*scene->materials[0].subsurface, 0), light);
  std::vector<float> found = light;
  spread.apply(0, 1, found);
  double worst = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    worst = std::max(worst, std::abs(found[i] - expected[i]));
  }
  EXPECT_LT(worst, 0.01) << "of light that is 0.5 on average";
  EXPECT_GT(worst, 1e-6) << "batches far away were to be taken together";
}

TEST(VertexSubsurface, EvenLightOnAFlatSurfaceStaysAndNoneIsMade) {
  for (const float scattering : {8.0f, 40.0f, 1000.0f}) {  // free paths of 1.5, 0.3, 0.01 edges
    const auto scene = translucent({grid(24)}, {{1, 1, 1}, Vec3f::filled(scattering), 1.4f});
    const PreparedVertices prepared = prepare_vertices(*scene);
    std::vector<float> light(prepared.mesh.positions.size(), 1.0f);
    SubsurfaceSpread(prepared.mesh, scene->materials).apply(0, 1, light);
    for (std::size_t i = 0; i < light.size(); ++i) {
      const Vec3f& p = prepared.mesh.positions[i];
      EXPECT_LE(light[i], 1 + 1e-6f);
      if (std::max(std::abs(p.x), std::abs(p.z)) > 0.4f) continue;
      EXPECT_GT(light[i], 0.9f) << scattering;
    }
  }
}

TEST(VertexSubsurface, ALitSpotGlowsAroundByTheDipole) {
  const auto scene = translucent({grid(40)}, {{0.5f, 2, 8}, {10, 10, 10}, 1.3f});
  const PreparedVertices prepared = prepare_vertices(*scene);
  const SubsurfaceSpread spread(prepared.mesh, scene->materials);
  EXPECT_TRUE(spread.is_coloured());
  const auto& positions = prepared.mesh.positions;
  const auto lit = static_cast<std::size_t>(
      std::ranges::min_element(positions, {}, [](const Vec3f& p) { return dot(p, p); }) -
      positions.begin());
  const double area = vertex_areas(prepared.mesh)[lit];
  for (int c = 0; c < 3; ++c) {
    std::vector<float> light(2 * positions.size());
    light[2 * lit + 1] = 1;  // the second of two coefficients
    spread.apply(c, 2, light);
    const DiffusionDipole dipole = dipole_of(*scene->materials[0].subsurface, c);
    int tested = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      EXPECT_EQ(light[2 * i], 0);
      const double r = length(positions[i] - positions[lit]);
      if (i == lit || r > 0.25) continue;
      const double expected = dipole.at(r) * area / dipole.reflectance();
      EXPECT_NEAR(light[2 * i + 1], expected, 0.08 * expected);
      ++tested;
    }
    EXPECT_GT(tested, 20);
  }
}

TEST(VertexSubsurface, LeavesOtherMaterialsAlone) {
  auto other = grid(10);
  for (Vec3f& p : other.positions) p.y += 0.01f;
  other.material = 1;
  auto scene = translucent({grid(10), other}, {{1, 1, 1}, {10, 10, 10}, 1.3f});
  scene->materials.emplace_back();
  const PreparedVertices prepared = prepare_vertices(*scene);
  std::vector<float> light;
  for (const std::uint32_t material : prepared.mesh.materials) {
    light.push_back(material == 1 ? 5.0f : 0.0f);
  }
  const std::vector<float> before = light;
  SubsurfaceSpread(prepared.mesh, scene->materials).apply(0, 1, light);
  EXPECT_EQ(light, before);
  scene->materials[0].subsurface.reset();
  EXPECT_FALSE(SubsurfaceSpread(prepared.mesh, scene->materials).is_needed());
}

}  // namespace
}  // namespace rimlight
