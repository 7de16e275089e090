#include "tests/core/bake/curve_scenes.h"

#include <cstddef>
#include <memory>
#include <utility>

#include "core/scene/shapes.h"
#include "tests/core/bake/bake_scenes.h"

namespace rimlight::test {
namespace {

/// A measured material of a broad gloss.
Material cloth() {
  FactoredBrdf factors;
  for (std::size_t i = 0; i < kCurveBins; ++i) {
    const auto share = static_cast<float>(i) / kCurveBins;
    factors.half_angle.values[i] = {0.5f - 0.4f * share, 0.3f, 0.1f};
    factors.difference_angle.values[i] = {0.6f, 0.6f + 0.2f * share, 0.6f};
  }
  factors.rest.fill({0.8f, 0.7f, 0.6f});
  Material material;
  material.name = "cloth";
  material.measured = std::make_shared<const MeasuredLobe>(factors);
  material.measured_name = "linen";
  material.brdf = {.model = BrdfModel::measured, .albedo = {}, .measured = material.measured.get()};
  return material;
}

std::shared_ptr<const RgbImage> chequered_texture() {
  RgbImage image(4, 4);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const auto value = static_cast<float>(i % 5) / 4;
    image.pixels[i] = {value, 1 - value, 0.5f};
  }
  return std::make_shared<const RgbImage>(std::move(image));
}

}  // namespace

std::shared_ptr<Scene> curve_scene() {
  auto scene = std::make_shared<Scene>();
  scene->name = "ball";
  scene->camera.position = {0.5, 2, 4};
  scene->camera.vertical_field_of_view_degrees = 35;
  Material pearl;
  pearl.name = "pearl";
  pearl.brdf.model = BrdfModel::blinn_phong;
  pearl.brdf.albedo = {0.4f, 0.3f, 0.2f};
  pearl.brdf.specular = {0.3f, 0.3f, 0.4f};
  pearl.brdf.exponent = 20;
  pearl.albedo_texture = chequered_texture();
  Material gold = metal(0.4f);
  gold.name = "gold";
  Material floor = lambert(0.6f);
  floor.name = "floor";
  scene->materials = {pearl, floor, gold, cloth()};
  Mesh ball = make_sphere(0.7, 24);
  scene->meshes = {std::move(ball), quad({-3, -0.7f, -3}, {0, 0, 6}, {6, 0, 0}, kFloor),
                   box({0.8f, -0.7f, -0.3f}, {1.5f, 0.6f, 0.4f}, kGold)};
  scene->meshes[0].material = kPearl;
  scene->meshes.push_back(box({-1.6f, -0.7f, -0.3f}, {-0.9f, 0.2f, 0.4f}, kCloth));
  scene->bake.width = 32;
  scene->bake.height = 32;
  scene->bake.cube_size = 8;
  scene->bake.primary_rays = 4;
  scene->bake.bounces = 0;
  return scene;
}

}  // namespace rimlight::test
