#include "core/scene/default_scene.h"

#include <gtest/gtest.h>

#include <memory>

#include "core/scene/mesh_geometry.h"
#include "core/scene/ray_scene.h"
#include "core/scene/terrace.h"

namespace rimlight {
namespace {

std::size_t triangle_count(const Scene& scene, std::string_view mesh_name = "") {
  std::size_t count = 0;
  for (const Mesh& mesh : scene.meshes) {
    if (mesh_name.empty() || mesh.name == mesh_name) count += mesh.triangles.size();
  }
  return count;
}

TEST(DefaultScene, HasTheSizeAndThePartsItIsKnownFor) {
  const Scene scene = default_scene();
  EXPECT_GE(triangle_count(scene), 100'000u);
  EXPECT_LE(triangle_count(scene), 200'000u);
  EXPECT_GE(triangle_count(scene, "leaves") / 7, 3000u);  // seven or eight triangles a leaf
  for (const char* part : {"slabs", "slats", "vase", "gold ring", "back wall", "left wall"}) {
    EXPECT_GT(triangle_count(scene, part), 0u) << part;
  }
  ASSERT_EQ(scene.environments.size(), 3u);
  EXPECT_EQ(scene.environments[0].name(), "sunny");
  EXPECT_EQ(scene.environments[1].name(), "studio");
  EXPECT_EQ(scene.environments[2].name(), "cathedral");
  for (const Mesh& mesh : scene.meshes) {
    ASSERT_LT(mesh.material, scene.materials.size());
    Mesh copy = mesh;
    EXPECT_EQ(drop_degenerate_triangles(copy), 0u) << mesh.name;
    for (const Vec3f& p : mesh.positions) ASSERT_TRUE(is_finite(p));
  }
}

TEST(DefaultScene, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const Scene a = terrace::make_scene(5);
  const Scene b = terrace::make_scene(5);
  const Scene other = terrace::make_scene(6);
  ASSERT_EQ(a.meshes.size(), b.meshes.size());
  bool differs = a.meshes.size() != other.meshes.size();
  for (std::size_t i = 0; i < a.meshes.size(); ++i) {
    ASSERT_EQ(a.meshes[i].positions, b.meshes[i].positions);
    ASSERT_EQ(a.meshes[i].triangles, b.meshes[i].triangles);
    ASSERT_EQ(a.meshes[i].material, b.meshes[i].material);
    differs = differs || a.meshes[i].positions != other.meshes[i].positions;
  }
  EXPECT_TRUE(differs);
}

TEST(DefaultScene, IsComposedWithSomeSky) {
  const auto scene = std::make_shared<const Scene>(terrace::make_scene(1));
  const RayScene rays(scene);
  constexpr int kSide = 128;
  int covered = 0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const Vec3d way = scene->camera.ray_direction(x + 0.5, y + 0.5, kSide, kSide);
      covered += rays.intersect({Vec3f(scene->camera.position), Vec3f(way)}).has_value();
    }
  }
  EXPECT_GT(covered, kSide * kSide * 7 / 10);
  EXPECT_LT(covered, kSide * kSide * 9 / 10);
}

}  // namespace
}  // namespace rimlight
