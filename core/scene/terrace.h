#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/math/random.h"
#include "core/scene/scene.h"
#include "core/scene/transform.h"

namespace rimlight::terrace {

/// The parts of the default scene. In metres; the floor is y = 0, the back wall looks to +z, the
/// terracotta wall to +x. Each part is seeded by itself.

/// Sides of the terrace.
inline constexpr double kLeft = -2.7, kRight = 2.7, kBack = -3.0, kFront = 3.6;

/// Meshes and materials of a scene in the making.
class Builder {
 public:
  Builder(Scene& scene, std::uint64_t seed) : scene_(&scene), seed_(seed) {}

  std::uint32_t material(std::string name, const Brdf& brdf);
  /// `count` Lambert materials about an albedo, lighter and darker by up to `spread` (relative).
  std::vector<std::uint32_t> tones(const std::string& name, const Vec3f& albedo, double spread,
                                   int count);
  void add(std::string name, Mesh mesh, std::uint32_t material, const Transform& transform = {});
  /// Pieces of one part that share a material become one mesh.
  void add_piece(const std::string& part, const Mesh& piece, std::uint32_t material,
                 const Transform& transform);
  Random random(std::uint64_t part) const { return Random(seed_, part); }

 private:
  Scene* scene_;
  std::uint64_t seed_;
};

/// The whole scene but for its environments.
Scene make_scene(std::uint64_t seed);

/// A box about the origin with chamfered edges; flat, without normals.
Mesh chamfered_box(const Vec3d& size, double chamfer);

void add_floor(Builder& builder);
void add_walls(Builder& builder);
void add_pergola(Builder& builder);
void add_plant(Builder& builder, const Vec3d& place);
/// What is seen through the arch: a lawn, a hedge, two cypresses.
void add_garden(Builder& builder);
void add_vase(Builder& builder, const Vec3d& place);
void add_ring(Builder& builder, const Vec3d& place);
void add_bench(Builder& builder, const Vec3d& place);
void add_bowl(Builder& builder, const Vec3d& place);

}  // namespace rimlight::terrace
