#include "core/vertices/vertex_scene.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace rimlight {
namespace {

constexpr int kLargestSide = 16384;

std::string range(int first, int last) {
  return std::to_string(first) + " to " + std::to_string(last);
}

/// Answers for one scene, each failure with its name.
class Checker {
 public:
  explicit Checker(const std::string& name) : name_(name) {}

  void equal(const char* field, std::size_t found, std::size_t expected) const {
    if (found != expected) fail(field, std::to_string(found), std::to_string(expected));
  }
  void within(const char* field, int found, int first, int last) const {
    if (found < first || found > last) fail(field, std::to_string(found), range(first, last));
  }
  void below(const char* field, std::size_t found, std::size_t end) const {
    if (found >= end) fail(field, std::to_string(found), "less than " + std::to_string(end));
  }
  void finite(const char* field, std::span<const Vec3f> values) const {
    if (!std::ranges::all_of(values, [](const Vec3f& v) { return is_finite(v); })) {
      fail(field, "a number that is not finite", "finite numbers");
    }
  }
  [[noreturn]] void fail(const char* field, const std::string& found,
                         const std::string& expected) const {
    throw Error(name_ + ": " + field, found, expected);
  }

 private:
  const std::string& name_;
};

void check_mesh(const Checker& check, const VertexMesh& mesh, std::size_t materials) {
  const std::size_t count = mesh.positions.size();
  check.equal("normals", mesh.normals.size(), count);
  check.equal("materials of vertices", mesh.materials.size(), count);
  check.equal("tints", mesh.tints.size(), count);
  check.finite("positions", mesh.positions);
  check.finite("normals", mesh.normals);
  check.finite("tints", mesh.tints);
  for (const std::uint32_t material : mesh.materials) {
    check.below("material of a vertex", material, materials);
  }
  for (const auto& corners : mesh.triangles) {
    for (const std::uint32_t corner : corners) check.below("corner of a triangle", corner, count);
  }
}

void check_transport(const Checker& check, const VertexTransportView& transport,
                     std::size_t vertices) {
  check.equal("transport: vertices", transport.vertex_count, vertices);
  check.below("transport: vertices with a highlight", transport.highlight_count, vertices + 1);
  check.within("transport: irradiance degree", transport.irradiance_degree, 0, sh::kLargestDegree);
  check.within("transport: visibility degree", transport.visibility_degree, 0, sh::kLargestDegree);
  if (transport.irradiance_channels > 3 || transport.irradiance_channels == 2) {
    check.fail("transport: channels", std::to_string(transport.irradiance_channels), "0, 1 or 3");
  }
  if (transport.irradiance_channels == 0) {
    check.equal("transport: normals", transport.normals.size(), vertices);
  }
  check.equal("transport: irradiance", transport.irradiance.size(),
              batch_count(vertices) * transport.irradiance_channels *
                  sh::coefficient_count(transport.irradiance_degree) * kBatchVertices);
  check.equal("transport: visibility", transport.visibility.size(),
              batch_count(transport.highlight_count) *
                  sh::coefficient_count(transport.visibility_degree) * kBatchVertices);
}

}  // namespace

void check_vertex_scene(const VertexScene& scene) {
  const Checker check(scene.name);
  if (!scene.mesh) check.fail("mesh", "none", "one");
  if (scene.materials.empty()) check.fail("materials", "none", "one or more");
  if (scene.environments.empty()) check.fail("environments", "none", "one or more");
  check.within("width", scene.width, 1, kLargestSide);
  check.within("height", scene.height, 1, kLargestSide);
  for (const VertexMaterial& material : scene.materials) {
    check.finite("material", std::vector{material.albedo, material.highlight});
    if (!(material.exponent >= 0) || !std::isfinite(material.exponent)) {
      check.fail("material: exponent", std::to_string(material.exponent), "0 or more");
    }
  }
  check_camera(scene.camera, scene.name + ": camera");
  check_mesh(check, *scene.mesh, scene.materials.size());
  check_transport(check, scene.transport, scene.mesh->positions.size());
}

VertexScene vertex_scene_of(std::shared_ptr<const VertexBake> bake) {
  VertexScene scene;
  scene.name = bake->folder().string();
  scene.mesh = std::shared_ptr<const VertexMesh>(bake, &bake->mesh());
  scene.materials = bake->materials();
  scene.transport = bake->transport();
  scene.camera = bake->camera();
  scene.width = bake->width();
  scene.height = bake->height();
  scene.environments = bake->environments();
  // The settings are for people, and may lack it: colours of their own come from surfaces only.
  const auto transfer = bake->settings().find("transfer");
  scene.has_interreflection = transfer != bake->settings().end()
                                  ? *transfer == "interreflected"
                                  : scene.transport.irradiance_channels == 3;
  const auto sun = bake->settings().find("sun");
  if (sun != bake->settings().end() && *sun == "directional") scene.sun = SunLight::directional;
  scene.error =
      bake_error_of(bake->settings(), bake->measured(), bake->left_out(),
                    std::max(scene.transport.irradiance_degree, scene.transport.visibility_degree));
  scene.memory = std::move(bake);
  scene.tree = std::make_shared<const TriangleTree>(scene.mesh->positions, scene.mesh->triangles,
                                                    scene.name);
  return scene;
}

}  // namespace rimlight
