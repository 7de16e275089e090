#include "tests/core/bake/bake_scenes.h"

namespace rimlight {

Mesh quad(const Vec3f& corner, const Vec3f& side_a, const Vec3f& side_b, std::uint32_t material) {
  Mesh mesh;
  mesh.name = "quad";
  mesh.positions = {corner, corner + side_a, corner + side_a + side_b, corner + side_b};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.material = material;
  return mesh;
}

Mesh box(const Vec3f& low, const Vec3f& high, std::uint32_t material) {
  Mesh mesh;
  mesh.name = "box";
  mesh.material = material;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.positions.push_back(
        {corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z});
  }
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

Material lambert(float albedo) {
  Material material;
  material.name = "lambert";
  material.brdf.albedo = {albedo, albedo, albedo};
  return material;
}

Material metal(float roughness) {
  Material material;
  material.name = "metal";
  material.brdf.model = BrdfModel::cook_torrance;
  material.brdf.albedo = {};
  material.brdf.specular = {1, 1, 1};
  material.brdf.roughness = roughness;
  material.brdf.eta = {0.2f, 0.4f, 1.2f};
  material.brdf.k = {3.5f, 2.5f, 2.0f};
  return material;
}

std::shared_ptr<Scene> convex_scene(const Material& material) {
  auto scene = std::make_shared<Scene>();
  scene->name = "convex";
  scene->camera.position = {3, 2.5, 4};
  scene->camera.vertical_field_of_view_degrees = 25;
  scene->materials = {material};
  scene->meshes = {box({-0.8f, -0.8f, -0.8f}, {0.8f, 0.8f, 0.8f}, 0)};
  scene->bake.width = 64;
  scene->bake.height = 64;
  scene->bake.cube_size = 16;
  return scene;
}

std::shared_ptr<Scene> corner_scene(const Material& material) {
  auto scene = convex_scene(material);
  scene->name = "corner";
  scene->camera.vertical_field_of_view_degrees = 35;
  scene->meshes = {quad({-1, -1, -1}, {3, 0, 0}, {0, 0, 3}, 0),
                   quad({-1, -1, -1}, {0, 3, 0}, {3, 0, 0}, 0),
                   quad({-1, -1, -1}, {0, 0, 3}, {0, 3, 0}, 0),
                   box({-0.6f, -1.0f, -0.6f}, {0.1f, -0.2f, 0.1f}, 0)};
  return scene;
}

}  // namespace rimlight
