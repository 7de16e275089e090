#include "core/scene/default_scene.h"

#include <cmath>
#include <numbers>

#include "core/light/environment.h"
#include "core/scene/terrace.h"

namespace rimlight {
namespace {

/// The terrace is built to be seen along −z and then turned as a whole, so that the sun of `sunny`
/// (62° to the right of −z) stands to the right of the camera and a little behind it.
constexpr double kTurn = 56 * std::numbers::pi / 180;

}  // namespace

Scene default_scene(std::uint64_t seed) {
  Scene scene;
  scene.name = "Terrace";
  terrace::Builder builder(scene, seed);
  terrace::add_floor(builder);
  terrace::add_walls(builder);
  terrace::add_pergola(builder);
  terrace::add_bench(builder, {-2.38, 0, -1.15});
  terrace::add_vase(builder, {-1.15, 0, -1.95});
  terrace::add_plant(builder, {1.62, 0, -2.1});
  terrace::add_bowl(builder, {-2.36, 0.435, -0.95});
  terrace::add_ring(builder, {0.33, 0, 1.75});

  const Transform turn = rotation(axis_angle({0, 1, 0}, kTurn));
  for (Mesh& mesh : scene.meshes) apply(turn, mesh);
  scene.camera.position = turn.point({1.55, 1.78, 6.4});
  scene.camera.target = turn.point({-0.38, 1.2, -1.0});
  scene.camera.vertical_field_of_view_degrees = 36;
  for (const std::string& name : builtin_environment_names()) {
    scene.environments.push_back(builtin_environment(name));
  }
  return scene;
}

}  // namespace rimlight
