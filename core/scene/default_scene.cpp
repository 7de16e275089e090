#include "core/scene/default_scene.h"

#include <cmath>
#include <numbers>

#include "core/light/environment.h"
#include "core/scene/terrace.h"

namespace rimlight {
namespace terrace {
namespace {

/// The terrace is built to be seen along −z and then turned as a whole, so that the sun of `sunny`
/// (62° to the right of −z) stands to the right of the camera and a little behind it.
constexpr double kTurn = 56 * std::numbers::pi / 180;

}  // namespace

Scene make_scene(std::uint64_t seed) {
  Scene scene;
  scene.name = "Terrace";
  Builder builder(scene, seed);
  add_floor(builder);
  add_walls(builder);
  add_pergola(builder);
  add_garden(builder);
  add_bench(builder, {-2.38, 0, -1.15});
  add_vase(builder, {-1.15, 0, -1.95});
  add_plant(builder, {1.62, 0, -2.1});
  add_bowl(builder, {-2.36, 0.435, -0.95});
  add_ring(builder, {0.33, 0, 1.75});

  const Transform turn = rotation(axis_angle({0, 1, 0}, kTurn));
  for (Mesh& mesh : scene.meshes) apply(turn, mesh);
  scene.camera.position = turn.point({1.55, 1.78, 6.4});
  scene.camera.target = turn.point({-0.38, 1.2, -1.0});
  scene.camera.vertical_field_of_view_degrees = 36;
  return scene;
}

}  // namespace terrace

Scene default_scene(std::uint64_t seed) {
  Scene scene = terrace::make_scene(seed);
  for (const std::string& name : builtin_environment_names()) {
    scene.environments.push_back(builtin_environment(name));
  }
  return scene;
}

}  // namespace rimlight
