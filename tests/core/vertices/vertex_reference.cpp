#include "tests/core/vertices/vertex_reference.h"

#include <cmath>
#include <numbers>

#include "core/base/half.h"
#include "core/basis/cube_map.h"
#include "core/basis/sh_zonal.h"
#include "core/vertices/vertex_renderer.h"
#include "tests/core/scene/scene_cases.h"
#include "tests/support/reference/triangles.h"

namespace rimlight::reference {
namespace {

/// Of a triangle's size: float arithmetic on coordinates of about 3 and sides of about 0.1.
constexpr double kEdge = 1e-3;

/// Coefficients of one vertex, of one channel of one kind of transport.
std::vector<double> row_of(std::span<const Half> transport, std::size_t vertex,
                           std::size_t channels, std::size_t channel, std::size_t count) {
  std::vector<double> row(count);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t batch = vertex / kBatchVertices * channels + channel;
    row[k] = to_float(transport[(batch * count + k) * kBatchVertices + vertex % kBatchVertices]);
  }
  return row;
}

double value_at(const std::vector<double>& coefficients, const std::vector<double>& harmonics) {
  double sum = 0;
  for (std::size_t k = 0; k < coefficients.size(); ++k) sum += coefficients[k] * harmonics[k];
  return sum;
}

std::shared_ptr<Scene> triangles_of(const VertexScene& scene) {
  Mesh mesh;
  mesh.positions = scene.mesh->positions;
  mesh.triangles = scene.mesh->triangles;
  return scene_of({mesh});
}

}  // namespace

VertexImage::VertexImage(const VertexScene& scene, const DesignState& state, int light_size)
    : scene_(scene), camera_(state.view.value_or(scene.camera)), materials_(scene.materials) {
  for (VertexMaterial& material : materials_) {
    const auto edit = state.materials.find(material.name);
    if (edit == state.materials.end()) continue;
    material.albedo = edit->second.albedo.value_or(material.albedo);
    material.highlight = edit->second.highlight.value_or(material.highlight);
    material.exponent = edit->second.exponent.value_or(material.exponent);
  }
  for (const BakedEnvironment& baked : scene.environments) {
    if (baked.environment->name() != state.environment) continue;
    CubeLight light = baked.environment->project(light_size);
    if (scene.sun == SunLight::directional) {
      SunAndSky split = split_sun(light);
      light = std::move(split.sky);
      sun_ = split.sun;
      if (sun_) sun_->direction = rotated(state.rotation, sun_->direction);
    }
    for (std::size_t t = 0; t < light.count(); ++t) {
      texels_.push_back({rotated(state.rotation, cube::texel_direction(t, light_size)),
                         Vec3d(light.at(t)) * cube::texel_solid_angle(t, light_size)});
    }
  }
}

VertexPixel VertexImage::pixel(int x, int y) const {
  VertexPixel pixel;
  for (const PixelPoint& point : kSmoothPoints) {
    add_point(x + point.x, y + point.y, 1.0 / kSmoothPoints.size(), pixel);
  }
  return pixel;
}

void VertexImage::add_sun(const SurfacePoint& at, double share, VertexPixel& pixel) const {
  const double cosine = dot(at.normal, sun_->direction);
  if (cosine <= 0) return;
  const VertexMesh& mesh = *scene_.mesh;
  const auto& corners = mesh.triangles[at.triangle];
  Vec3d flat, lift, tint;
  for (std::size_t k = 0; k < 3; ++k) {
    flat += Vec3d(mesh.positions[corners[k]]) * at.weights[k];
    tint += Vec3d(mesh.tints[corners[k]]) * at.weights[k];
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d normal(mesh.normals[corners[k]]);
    const double height = dot(flat - Vec3d(mesh.positions[corners[k]]), normal);
    if (height < 0) lift += normal * (-height * at.weights[k]);
  }
  // Beyond what a margin of kEdge reaches back.
  const Vec3d start = flat + lift + sun_->direction * (2 * kEdge);
  const auto triangles = triangles_of(scene_);
  const bool outer = nearest_hit(*triangles, start, sun_->direction, kEdge).has_value();
  if (outer != nearest_hit(*triangles, start, sun_->direction, -kEdge).has_value()) {
    pixel.is_safe = false;
  }
  if (outer) return;
  pixel.sun += share;
  const VertexMaterial& material = materials_[mesh.materials[corners[0]]];
  const double facing = std::max(0.0, dot(at.mirrored, sun_->direction));
  const bool is_glossy =
      std::max({corners[0], corners[1], corners[2]}) < scene_.transport.highlight_count;
  const double lobe = is_glossy ? (material.exponent + 1) / (2 * std::numbers::pi) *
                                      std::pow(facing, material.exponent)
                                : 0.0;
  for (int c = 0; c < 3; ++c) {
    const double diffuse = tint[c] * material.albedo[c] / std::numbers::pi * cosine;
    const double sum = share * sun_->irradiance[c] * (diffuse + material.highlight[c] * lobe);
    pixel.radiance[c] += sum;
    pixel.magnitude += sum;
  }
}

void VertexImage::add_point(double x, double y, double share, VertexPixel& pixel) const {
  const auto triangles = triangles_of(scene_);
  const Vec3d way = camera_.ray_direction(x, y, scene_.width, scene_.height);
  const auto hit = nearest_hit(*triangles, camera_.position, way, kEdge);
  const auto inside = nearest_hit(*triangles, camera_.position, way, -kEdge);
  if (hit.has_value() != inside.has_value() || (hit && hit->triangle != inside->triangle)) {
    pixel.is_safe = false;
    return;
  }
  if (!hit) return;
  pixel.coverage += share;
  const VertexTransportView& transport = scene_.transport;
  const VertexMesh& mesh = *scene_.mesh;
  const auto& corners = mesh.triangles[hit->triangle];
  const double weights[3] = {1 - hit->u - hit->v, hit->u, hit->v};
  const VertexMaterial& material = materials_[mesh.materials[corners[0]]];
  Vec3d normal;
  for (std::size_t k = 0; k < 3; ++k) normal += Vec3d(mesh.normals[corners[k]]) * weights[k];
  normal = normalized(normal);
  const Vec3d mirrored = way - normal * (2 * dot(way, normal));
  if (sun_) {
    add_sun({hit->triangle, {weights[0], weights[1], weights[2]}, normal, mirrored}, share, pixel);
  }
  const auto lobe = sh::phong_lobe(material.exponent, transport.visibility_degree);
  const bool is_glossy = std::max({corners[0], corners[1], corners[2]}) < transport.highlight_count;
  const std::size_t irradiance_count = sh::coefficient_count(transport.irradiance_degree);
  const std::size_t visibility_count = sh::coefficient_count(transport.visibility_degree);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d albedo = Vec3d(mesh.tints[corners[k]]) * Vec3d(material.albedo);
    std::vector<std::vector<double>> irradiance;
    for (std::size_t c = 0; c < transport.irradiance_channels; ++c) {
      irradiance.push_back(row_of(transport.irradiance, corners[k], transport.irradiance_channels,
                                  c, irradiance_count));
    }
    std::vector<double> visibility;
    if (is_glossy) visibility = row_of(transport.visibility, corners[k], 1, 0, visibility_count);
    for (const Texel& texel : texels_) {
      const auto harmonics = sh::evaluate(
          texel.direction, std::max(transport.irradiance_degree, transport.visibility_degree));
      const double highlight = is_glossy ? value_at(visibility, harmonics) *
                                               sh::lobe_value(lobe, dot(mirrored, texel.direction))
                                         : 0.0;
      for (int c = 0; c < 3; ++c) {
        const auto& row = irradiance[irradiance.size() == 1 ? 0 : static_cast<std::size_t>(c)];
        const double diffuse = albedo[c] / std::numbers::pi * value_at(row, harmonics);
        const double sum =
            share * weights[k] * texel.flux[c] * (diffuse + material.highlight[c] * highlight);
        pixel.radiance[c] += sum;
        pixel.magnitude += std::abs(sum);
      }
    }
  }
}

}  // namespace rimlight::reference
