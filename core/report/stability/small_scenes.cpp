#include "core/report/stability/small_scenes.h"

#include <stdlib.h>  // NOLINT: mkdtemp is POSIX, not in <cstdlib>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <system_error>
#include <utility>

#include "core/bake/group_baker.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/basis/cube_haar.h"
#include "core/math/random.h"
#include "core/scene/shapes.h"
#include "core/transport/receivers.h"

namespace rimlight::stability {
namespace {

void move_by(Mesh& mesh, const Vec3f& offset) {
  for (Vec3f& position : mesh.positions) position += offset;
}

Environment grey_sky() {
  RgbImage image(16, 8);
  for (Vec3f& pixel : image.pixels) pixel = {1, 1, 1};
  return Environment("sky", std::move(image));
}

/// A group's radiance under a light's coefficients, lane by lane.
void add_radiance(const BakedGroup& group, const CubeLight& light, std::vector<Vec3f>& radiance) {
  for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
    if (!(group.coverage[lane] > 0)) continue;
    Vec3d sum;
    for (std::size_t j = 0; j < light.count(); ++j) {
      const Vec3f coefficient = light.at(j);
      for (int c = 0; c < 3; ++c) {
        const std::size_t at = static_cast<std::size_t>(c) * kGroupLanes + lane;
        sum[c] += double{coefficient[c]} * double{group.coefficients.row(j)[at]};
      }
    }
    radiance.push_back(Vec3f(sum));
  }
}

}  // namespace

Material matte(float albedo) {
  Material material;
  material.name = "matte";
  material.brdf.albedo = Vec3f::filled(albedo);
  return material;
}

void scale_by(Mesh& mesh, double scale) {
  for (Vec3f& position : mesh.positions) position = Vec3f(Vec3d(position) * scale);
}

std::shared_ptr<Scene> still_life(double scale) {
  auto scene = std::make_shared<Scene>();
  scene->name = "still life";
  scene->materials = {matte(0.6f)};
  scene->meshes = {make_plane(6, 6), make_sphere(0.7, 24), make_box({0.8, 1, 0.8})};
  move_by(scene->meshes[1], {-0.6f, 0.7f, 0});
  move_by(scene->meshes[2], {0.9f, 0.5f, -0.3f});
  for (Mesh& mesh : scene->meshes) scale_by(mesh, scale);
  scene->camera.position = Vec3d(2, 2.5, 4) * scale;
  scene->camera.target = Vec3d(0, 0.5, 0) * scale;
  scene->environments = {grey_sky()};
  scene->bake.width = scene->bake.height = 24;
  scene->bake.cube_size = 8;
  scene->bake.primary_rays = 4;
  scene->bake.bounces = 2;
  scene->bake.vertex.degree = 4;
  scene->bake.vertex.most_rays = 256;
  scene->bake.vertex.longest_edge = 0;
  return scene;
}

std::shared_ptr<Scene> open_sphere(const OpenSphere& settings) {
  auto scene = std::make_shared<Scene>();
  scene->name = "open sphere";
  scene->materials = {matte(settings.albedo)};
  // A cap is as large a part of a sphere as of its height.
  const double first = std::acos(1 - 2 * settings.open);
  std::vector<ProfilePoint> profile;
  const int rings = settings.segments / 2;
  for (int ring = 0; ring <= rings; ++ring) {
    const double angle = first + (std::numbers::pi - first) * ring / rings;
    profile.push_back({ring == rings ? 0 : std::sin(angle), std::cos(angle)});
  }
  scene->meshes = {lathe(profile, settings.segments)};  // walked downward: normals look inside
  if (settings.kind != BakeKind::vertex_sh) scene->meshes[0].normals.clear();
  scene->camera.position = {0, 0, 0};
  scene->camera.target = {0.3, -1, 0.2};
  scene->camera.vertical_field_of_view_degrees = 60;
  scene->environments = {grey_sky()};
  scene->bake.kind = settings.kind;
  scene->bake.width = scene->bake.height = 16;
  scene->bake.cube_size = 8;
  scene->bake.primary_rays = 8;
  scene->bake.vertex.degree = 2;
  scene->bake.vertex.longest_edge = 0;
  scene->bake.vertex.error = 0.005;
  return scene;
}

std::vector<Vec3f> picture_of(const std::shared_ptr<const Scene>& scene, const CubeLight& light) {
  const RayScene rays(scene);
  const GroupBaker baker(rays);
  const CubeLight coefficients = coefficients_of(light);
  const std::size_t groups = baker.layout().receiver_count() / kGroupLanes;
  std::vector<std::vector<Vec3f>> parts(groups);
  parallel_for(groups, [&](std::size_t i) {
    BakedGroup group(baker.cube_size());
    baker.find_rows(i * kGroupLanes, group);
    if (!group.empty) add_radiance(group, coefficients, parts[i]);
  });
  std::vector<Vec3f> radiance;
  for (const auto& part : parts) radiance.insert(radiance.end(), part.begin(), part.end());
  return radiance;
}

CubeLight coefficients_of(const CubeLight& texels) {
  CubeLight light(texels.size), scratch = texels;
  const CubeHaar haar(texels.size);
  for (int c = 0; c < 3; ++c) haar.forward(scratch.channel(c), light.channel(c));
  return light;
}

CubeLight uniform_sky(int size) {
  CubeLight light(size);
  std::ranges::fill(light.values, 1.0f);
  return light;
}

CubeLight random_sky(int size) {
  CubeLight light(size);
  Random random(1);
  for (float& value : light.values) value = random.uniform_float();
  return light;
}

ScratchFolder::ScratchFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "rimlight-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) {
    throw Error(name, std::generic_category().message(errno), "a folder to write to");
  }
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace rimlight::stability
