#include "core/bake/fingerprint.h"

#include <array>
#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

#include "core/transport/bake_folder.h"
#include "core/transport/tensor_file.h"

namespace rimlight {
namespace {

/// Raised whenever the bake gives other bytes for the same scene.
constexpr std::uint64_t kBakeRevision = 1;

class Hasher {
 public:
  template <typename T>
  void add(const T& value) {
    static_assert(std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>);
    hash_ = hash_bytes(std::as_bytes(std::span(&value, 1)), hash_);
  }
  void add(const Vec3f& v) {
    add(v.x);
    add(v.y);
    add(v.z);
  }
  void add(const Vec3d& v) {
    add(v.x);
    add(v.y);
    add(v.z);
  }
  template <std::size_t kCount>
  void add(const std::array<Vec3f, kCount>& values) {
    for (const Vec3f& value : values) add(value);
  }
  template <typename T>
  void add_all(const std::vector<T>& values) {
    add(values.size());
    hash_ = hash_bytes(std::as_bytes(std::span(values)), hash_);
  }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0;
};

void add_material(Hasher& hasher, const Material& material) {
  const Brdf& brdf = material.brdf;
  hasher.add(brdf.model);
  hasher.add(brdf.albedo);
  hasher.add(brdf.specular);
  hasher.add(brdf.exponent);
  hasher.add(brdf.roughness);
  hasher.add(brdf.eta);
  hasher.add(brdf.k);
  // Only where they count, so that older bakes keep their names.
  if (brdf.model == BrdfModel::ward || brdf.model == BrdfModel::ashikhmin_shirley) {
    hasher.add(brdf.exponent_across);
    hasher.add(brdf.roughness_across);
    hasher.add(material.tangent);
  }
  if (material.measured != nullptr) {
    const FactoredBrdf& factors = material.measured->factors();
    hasher.add(factors.half_angle.values);
    hasher.add(factors.difference_angle.values);
    hasher.add(factors.rest);
  }
  if (material.albedo_texture == nullptr) return;
  hasher.add(material.albedo_texture->width);
  hasher.add_all(material.albedo_texture->pixels);
}

}  // namespace

std::uint64_t fingerprint(const Scene& scene) {
  Hasher hasher;
  hasher.add(kBakeRevision);
  hasher.add(kBakeVersion);
  hasher.add(scene.camera.position);
  hasher.add(scene.camera.target);
  hasher.add(scene.camera.up);
  hasher.add(scene.camera.vertical_field_of_view_degrees);
  for (const Material& material : scene.materials) add_material(hasher, material);
  for (const Mesh& mesh : scene.meshes) {
    hasher.add_all(mesh.positions);
    hasher.add_all(mesh.normals);
    hasher.add_all(mesh.texture_coordinates);
    hasher.add_all(mesh.triangles);
    hasher.add(mesh.material);
  }
  const BakeSettings& bake = scene.bake;
  for (const int value :
       {bake.width, bake.height, bake.cube_size, bake.primary_rays, bake.bounces}) {
    hasher.add(value);
  }
  hasher.add(bake.psnr_db);
  hasher.add(bake.seed);
  return hasher.value();
}

}  // namespace rimlight
