#include "core/report/lit_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/basis/sh_kernel.h"
#include "core/basis/sh_projection.h"
#include "core/scene/mesh_geometry.h"
#include "core/scene/ray_scene.h"

namespace rimlight {
namespace {

constexpr int kLightSize = 64;
/// Of the mesh's extent: shadow rays start so far above their vertex.
constexpr float kRayOffset = 2e-4f;
/// Of the mesh's extent: how far the eye is from the middle.
constexpr double kEyeDistance = 2;

/// Appends a mesh without its material.
void append(const Mesh& mesh, Mesh& all) {
  const auto first = static_cast<std::uint32_t>(all.positions.size());
  all.positions.insert(all.positions.end(), mesh.positions.begin(), mesh.positions.end());
  all.normals.insert(all.normals.end(), mesh.normals.begin(), mesh.normals.end());
  for (const auto& corners : mesh.triangles) {
    all.triangles.push_back({first + corners[0], first + corners[1], first + corners[2]});
  }
}

Mesh join(std::vector<Mesh>& meshes) {
  Mesh all;
  for (Mesh& mesh : meshes) {
    drop_degenerate_triangles(mesh);
    if (mesh.normals.size() != mesh.positions.size()) smooth_normals(mesh);
    append(mesh, all);
  }
  return all;
}

/// The vertices that triangles use, in the order in which they do; those that agree in position and
/// normal become one (files repeat them for each triangle).
VertexMesh used_vertices(const Mesh& mesh) {
  using Key = std::array<float, 6>;
  std::map<Key, std::uint32_t> places;
  VertexMesh used;
  for (const auto& corners : mesh.triangles) {
    std::array<std::uint32_t, 3> moved{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f &position = mesh.positions[corners[k]], &normal = mesh.normals[corners[k]];
      const auto next = static_cast<std::uint32_t>(used.positions.size());
      const auto [place, is_new] = places.try_emplace(
          Key{position.x, position.y, position.z, normal.x, normal.y, normal.z}, next);
      if (is_new) {
        used.positions.push_back(position);
        used.normals.push_back(normal);
      }
      moved[k] = place->second;
    }
    used.triangles.push_back(moved);
  }
  used.materials.assign(used.positions.size(), 0);
  used.tints.assign(used.positions.size(), Vec3f::filled(1));
  return used;
}

RayScene ray_scene(const VertexMesh& mesh) {
  auto scene = std::make_shared<Scene>();
  scene->materials.emplace_back();
  Mesh& only = scene->meshes.emplace_back();
  only.positions = mesh.positions;
  only.normals = mesh.normals;
  only.triangles = mesh.triangles;
  return RayScene(std::move(scene));
}

/// A spherical Fibonacci lattice (Keinert et al. 2015): any number of even directions.
std::vector<Vec3d> even_directions() {
  std::vector<Vec3d> directions;
  const auto count = static_cast<double>(kSkyDirections);
  for (std::size_t i = 0; i < kSkyDirections; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / count;
    const double azimuth = 2 * std::numbers::pi * std::numbers::phi * static_cast<double>(i);
    const double radius = std::sqrt(1 - z * z);
    directions.push_back({radius * std::cos(azimuth), radius * std::sin(azimuth), z});
  }
  return directions;
}

/// Rays of one vertex and their results.
struct SkyView {
  std::vector<Ray> rays;
  std::vector<std::uint32_t> directions;  // of the rays
  std::array<std::uint8_t, kSkyDirections> visible{};
};

/// Traces and sums up the transport of vertices.
class SkyTracer {
 public:
  SkyTracer(LitMesh& lit, const RayScene& scene)
      : lit_(lit), scene_(scene), lattice_(even_directions()) {
    const std::size_t count = sh::coefficient_count(lit.degree);
    AlignedVector<float> values(count * kSkyDirections);
    sh::evaluate(sh::Directions(lattice_).all(), lit.degree, values, kSkyDirections);
    basis_.resize(values.size());
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t d = 0; d < kSkyDirections; ++d) {
        basis_[d * count + i] = values[i * kSkyDirections + d];
      }
    }
  }

  void trace(std::size_t vertex) const {
    thread_local SkyView view;
    const Vec3f normal = lit_.mesh.normals[vertex];
    const Vec3f origin = lit_.mesh.positions[vertex] + normal * (kRayOffset * scene_.extent());
    view.rays.clear();
    view.directions.clear();
    for (std::uint32_t d = 0; d < kSkyDirections; ++d) {
      const Vec3f direction(lattice_[d]);
      if (!(dot(direction, normal) > 0)) continue;
      view.rays.push_back({origin, direction});
      view.directions.push_back(d);
    }
    scene_.visible(view.rays, {}, std::span(view.visible).first(view.rays.size()));
    store(vertex, view);
  }

 private:
  void store(std::size_t vertex, const SkyView& view) const {
    const std::size_t count = sh::coefficient_count(lit_.degree);
    std::vector<float> irradiance(count), visibility(count);
    for (std::size_t r = 0; r < view.rays.size(); ++r) {
      if (view.visible[r] == 0) continue;
      const float cosine = dot(view.rays[r].direction, lit_.mesh.normals[vertex]);
      const float* const values = basis_.data() + view.directions[r] * count;
      for (std::size_t i = 0; i < count; ++i) {
        visibility[i] += values[i];
        irradiance[i] += cosine * values[i];
      }
    }
    constexpr auto kWeight = static_cast<float>(4 * std::numbers::pi / kSkyDirections);
    const std::size_t place =
        vertex / kBatchVertices * count * kBatchVertices + vertex % kBatchVertices;
    for (std::size_t i = 0; i < count; ++i) {
      lit_.visibility[place + i * kBatchVertices] = to_half(kWeight * visibility[i]);
      lit_.irradiance[place + i * kBatchVertices] = to_half(kWeight * irradiance[i]);
    }
  }

  LitMesh& lit_;
  const RayScene& scene_;
  std::vector<Vec3d> lattice_;
  AlignedVector<float> basis_;  // [direction][coefficient]
};

}  // namespace

VertexTransportView LitMesh::view() const {
  const std::size_t vertices = mesh.positions.size();
  return {vertices, vertices, degree, degree, 1, irradiance, visibility};
}

LitMesh LitMesh::to_degree(int lower) const {
  RIMLIGHT_CHECK(lower >= 0 && lower <= degree);
  LitMesh cut{name, mesh, lower, {}, {}};
  const std::size_t from = sh::coefficient_count(degree) * kBatchVertices;
  const std::size_t kept = sh::coefficient_count(lower) * kBatchVertices;
  for (std::size_t at = 0; at < irradiance.size(); at += from) {
    const auto copy = [&](const AlignedVector<Half>& all, AlignedVector<Half>& to) {
      const auto begin = all.begin() + static_cast<std::ptrdiff_t>(at);
      to.insert(to.end(), begin, begin + static_cast<std::ptrdiff_t>(kept));
    };
    copy(irradiance, cut.irradiance);
    copy(visibility, cut.visibility);
  }
  return cut;
}

LitMesh light_mesh(std::string name, std::vector<Mesh> meshes, int degree) {
  LitMesh lit;
  lit.name = std::move(name);
  lit.degree = degree;
  lit.mesh = used_vertices(join(meshes));
  if (lit.mesh.triangles.empty()) throw Error(lit.name, "no triangles", "a mesh");
  const std::size_t vertices = lit.mesh.positions.size();
  const std::size_t size = batch_count(vertices) * sh::coefficient_count(degree) * kBatchVertices;
  lit.irradiance.resize(size);
  lit.visibility.resize(size);
  const RayScene scene = ray_scene(lit.mesh);
  const SkyTracer tracer(lit, scene);
  constexpr std::size_t kChunk = 256;
  parallel_for((vertices + kChunk - 1) / kChunk, [&](std::size_t chunk) {
    const std::size_t end = std::min(vertices, (chunk + 1) * kChunk);
    for (std::size_t v = chunk * kChunk; v < end; ++v) tracer.trace(v);
  });
  return lit;
}

std::vector<float> light_coefficients(const Environment& environment, int degree) {
  const CubeLight texels = environment.project(kLightSize);
  const sh::SphereQuadrature quadrature = sh::cube_quadrature(kLightSize);
  std::vector<float> values;
  values.reserve(texels.values.size());
  for (int c = 0; c < 3; ++c) {
    const auto channel = texels.channel(c);
    values.insert(values.end(), channel.begin(), channel.end());
  }
  return sh::project(quadrature, values, degree);
}

MeshView view_mesh(const LitMesh& lit, const Vec3d& eye_direction) {
  const RayScene scene = ray_scene(lit.mesh);
  Vec3d low = Vec3d::filled(1e300), high = Vec3d::filled(-1e300);
  for (const Vec3f& position : lit.mesh.positions) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], static_cast<double>(position[k]));
      high[k] = std::max(high[k], static_cast<double>(position[k]));
    }
  }
  const double distance = kEyeDistance * static_cast<double>(scene.extent());
  const Vec3f eye((low + high) * 0.5 + normalized(eye_direction) * distance);
  MeshView view;
  std::vector<Ray> rays;
  std::vector<float> far;
  for (std::size_t v = 0; v < lit.mesh.positions.size(); ++v) {
    const Vec3f& normal = lit.mesh.normals[v];
    const Vec3f origin = lit.mesh.positions[v] + normal * (kRayOffset * scene.extent());
    const Vec3f to_eye = eye - origin;
    rays.push_back({origin, normalized(to_eye)});
    far.push_back(length(to_eye));
    view.mirrored.push_back(normal * (2 * dot(normal, rays.back().direction)) -
                            rays.back().direction);
  }
  std::vector<std::uint8_t> seen(rays.size());
  scene.visible(rays, far, seen);
  for (std::size_t v = 0; v < rays.size(); ++v) {
    const bool faces = dot(rays[v].direction, lit.mesh.normals[v]) > 0;
    if (faces && seen[v] != 0) view.visible.push_back(static_cast<std::uint32_t>(v));
  }
  return view;
}

}  // namespace rimlight
