#pragma once

#include <filesystem>
#include <memory>
#include <utility>

#include "core/bake/vertex_sh_bake.h"
#include "core/vertices/vertex_renderer.h"
#include "tests/core/scene/scene_cases.h"
#include "tests/core/vertices/vertex_case.h"

namespace rimlight::test {

inline Material painted(const std::string& name, const Vec3f& albedo, float specular) {
  Material material;
  material.name = name;
  material.brdf = {.model = specular > 0 ? BrdfModel::phong : BrdfModel::lambert,
                   .albedo = albedo,
                   .specular = {specular, specular, specular},
                   .exponent = 20};
  return material;
}

inline void add_normals(const Vec3d& centre, Mesh& sphere) {
  for (const Vec3f& p : sphere.positions) {
    sphere.normals.push_back(Vec3f(normalized(Vec3d(p) - centre)));
  }
}

/// Two glossy balls close to each other and to a matt floor that fills the picture.
inline std::shared_ptr<Scene> balls_scene() {
  auto scene = std::make_shared<Scene>();
  scene->name = "balls";
  scene->camera.position = {0, 3.2, 1.6};
  scene->camera.target = {0, 0, 0};
  scene->materials = {painted("floor", {0.5f, 0.45f, 0.4f}, 0),
                      painted("ball", {0.3f, 0.2f, 0.15f}, 0.3f)};
  Mesh floor;
  floor.positions = {{-4, 0, -4}, {-4, 0, 4}, {4, 0, 4}, {4, 0, -4}};
  floor.triangles = {{0, 1, 2}, {0, 2, 3}};
  floor.normals.assign(4, {0, 1, 0});
  Mesh left = test_sphere({-0.5f, 0.55f, 0}, 0.5f, 14);
  Mesh right = test_sphere({0.55f, 0.55f, 0.1f}, 0.5f, 14);
  add_normals({-0.5, 0.55, 0}, left);
  add_normals({0.55, 0.55, 0.1}, right);
  left.material = right.material = 1;
  scene->meshes = {std::move(floor), std::move(left), std::move(right)};
  scene->environments = {*sky("sky"), *sky("dim", 0.25f)};
  scene->bake.kind = BakeKind::vertex_sh;
  scene->bake.width = 160;
  scene->bake.height = 120;
  scene->bake.vertex = {.degree = 6,
                        .error = 0.03,
                        .transfer = VertexTransfer::shadowed,
                        .keep_bands = true,
                        .longest_edge = 0.04};
  return scene;
}

inline std::shared_ptr<const VertexScene> baked(const std::shared_ptr<Scene>& scene,
                                                const std::filesystem::path& folder) {
  bake_vertices(scene, folder, {});
  return std::make_shared<const VertexScene>(
      vertex_scene_of(std::make_shared<const VertexBake>(folder)));
}

/// √ of Σ of squared differences, and of squares.
inline double distance(const RgbImage& a, const RgbImage& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const Vec3d difference = Vec3d(a.pixels[i]) - Vec3d(b.pixels[i]);
    sum += dot(difference, difference);
  }
  return std::sqrt(sum);
}
inline double size_of(const RgbImage& image) {
  double sum = 0;
  for (const Vec3f& pixel : image.pixels) sum += static_cast<double>(dot(pixel, pixel));
  return std::sqrt(sum);
}

}  // namespace rimlight::test
