// make_bake DIR.bake SIDE [vertex_sh | brdf_curve]: bakes a small scene made here (a glossy ball, a
// matte one and a wall on a floor) for the tests that need a real bake in seconds.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <memory>

#include "core/bake/image_bake.h"
#include "core/bake/vertex_sh_bake.h"
#include "core/light/environment.h"
#include "core/scene/scene.h"

namespace rimlight {
namespace {

constexpr double kPi = 3.14159265358979323846;

Mesh quad(const std::string& name, std::uint32_t material, const Vec3f& corner, const Vec3f& u,
          const Vec3f& v) {
  Mesh mesh;
  mesh.name = name;
  mesh.material = material;
  mesh.positions = {corner, corner + u, corner + u + v, corner + v};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

Mesh ball(const std::string& name, std::uint32_t material, const Vec3f& centre, float radius) {
  constexpr std::uint32_t kRings = 24;
  constexpr std::uint32_t kSegments = 48;
  Mesh mesh;
  mesh.name = name;
  mesh.material = material;
  for (std::uint32_t ring = 0; ring <= kRings; ++ring) {
    for (std::uint32_t segment = 0; segment <= kSegments; ++segment) {
      const double theta = kPi * ring / kRings;
      const double phi = 2 * kPi * segment / kSegments;
      const Vec3f normal(
          Vec3d{std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi)});
      mesh.positions.push_back(centre + normal * radius);
      mesh.normals.push_back(normalized(normal));
    }
  }
  for (std::uint32_t ring = 0; ring < kRings; ++ring) {
    for (std::uint32_t segment = 0; segment < kSegments; ++segment) {
      const std::uint32_t a = ring * (kSegments + 1) + segment;
      const std::uint32_t b = a + kSegments + 1;
      if (ring > 0) mesh.triangles.push_back({a, b, a + 1});
      if (ring + 1 < kRings) mesh.triangles.push_back({a + 1, b, b + 1});
    }
  }
  return mesh;
}

std::shared_ptr<Scene> make_scene(int side) {
  auto scene = std::make_shared<Scene>();
  scene->name = "balls";
  scene->camera.position = {0, 1.6, 5};
  scene->camera.target = {0, 0.6, 0};
  scene->camera.vertical_field_of_view_degrees = 36;
  scene->materials.resize(3);
  scene->materials[0].name = "floor";
  scene->materials[0].brdf.albedo = {0.6f, 0.58f, 0.55f};
  scene->materials[1].name = "clay";
  scene->materials[1].brdf.albedo = {0.7f, 0.35f, 0.2f};
  scene->materials[2].name = "wall";
  scene->materials[2].brdf.albedo = {0.25f, 0.4f, 0.6f};
  scene->meshes = {quad("floor", 0, {-4, 0, 4}, {8, 0, 0}, {0, 0, -8}),
                   quad("wall", 2, {-2.2f, 0, 1}, {0, 0, -3}, {0, 1.8f, 0}),
                   ball("large", 1, {-0.6f, 0.8f, 0}, 0.8f),
                   ball("small", 0, {0.9f, 0.4f, 0.7f}, 0.4f)};
  for (const std::string& name : builtin_environment_names()) {
    scene->environments.push_back(builtin_environment(name));
  }
  scene->bake.width = side;
  scene->bake.height = side;
  scene->bake.cube_size = 16;
  scene->bake.primary_rays = 4;
  scene->bake.bounces = 1;
  return scene;
}

/// The same scene by its vertices, the clay glazed.
void bake_its_vertices(const std::shared_ptr<Scene>& scene, const char* folder) {
  scene->bake.kind = BakeKind::vertex_sh;
  scene->bake.vertex.degree = 6;
  scene->bake.vertex.error = 0.05;
  scene->bake.vertex.most_rays = 256;
  scene->bake.vertex.longest_edge = 0;
  Brdf& clay = scene->materials[1].brdf;
  clay.model = BrdfModel::phong;
  clay.specular = {0.2f, 0.2f, 0.2f};
  clay.exponent = 20;
  bake_vertices(scene, folder, {});
}

/// The same scene, the clay glazed with curves to edit.
void bake_its_curves(const std::shared_ptr<Scene>& scene, const char* folder) {
  scene->bake.kind = BakeKind::brdf_curve;
  Brdf& clay = scene->materials[1].brdf;
  clay.model = BrdfModel::cook_torrance;
  clay.specular = {1, 1, 1};
  clay.roughness = 0.25f;
  bake_curves(scene, folder, {});
}

}  // namespace
}  // namespace rimlight

int main(int argc, char** argv) {
  const bool of_vertices = argc == 4 && std::strcmp(argv[3], "vertex_sh") == 0;
  const bool of_curves = argc == 4 && std::strcmp(argv[3], "brdf_curve") == 0;
  const int side = argc == 3 || of_vertices || of_curves ? std::atoi(argv[2]) : 0;
  if (side < 16 || side > 1024) {
    std::fprintf(stderr, "usage: make_bake DIR.bake SIDE (16 to 1024) [vertex_sh | brdf_curve]\n");
    return 2;
  }
  try {
    const auto scene = rimlight::make_scene(side);
    if (of_vertices) {
      rimlight::bake_its_vertices(scene, argv[1]);
    } else if (of_curves) {
      rimlight::bake_its_curves(scene, argv[1]);
    } else {
      rimlight::bake_image(scene, argv[1], {});
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_bake: %s\n", error.what());
    return 1;
  }
}
