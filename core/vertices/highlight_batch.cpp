#include "core/vertices/highlight_batch.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "core/basis/sh_kernel.h"

namespace rimlight {
namespace {

static_assert(HighlightBatch::kPixels == kPanelLanes);

/// (s + 1)/2π · max(0, cosine)^s.
float phong_value(double exponent, double cosine) {
  // No way (zero: no highlight is there) looks like one at right angles.
  if (!(cosine > 0)) return 0;
  return static_cast<float>((exponent + 1) / (2 * std::numbers::pi) *
                            std::pow(std::min(cosine, 1.0), exponent));
}

using Corners = std::array<std::uint32_t, 3>;

/// What a pixel reflects of the sun.
Vec3f sunlight(const VertexShading& shading, std::size_t layer, int x, int y,
               const Corners& corners, const std::array<float, 3>& weights) {
  const SunAtPoint& at = shading.shadows.at(
      layer, static_cast<std::size_t>(y) * static_cast<std::size_t>(shading.view.width()) +
                 static_cast<std::size_t>(x));
  if (!(at.visible > 0)) return {};
  const VertexMesh& mesh = shading.mesh;
  const std::uint32_t index = mesh.materials[corners[0]];
  const VertexMaterial& material = shading.materials.at(index);
  const Vec3f tint = mesh.tints[corners[0]] * weights[0] + mesh.tints[corners[1]] * weights[1] +
                     mesh.tints[corners[2]] * weights[2];
  Vec3f reflected = tint * material.albedo * (at.cosine * std::numbers::inv_pi_v<float>);
  if (shading.materials.has_highlight(index)) {
    const Vec3f& way = shading.view.mirrored(layer, x, y);
    reflected += material.highlight *
                 phong_value(material.exponent, dot(Vec3d(way), shading.sun->direction));
  }
  return reflected * Vec3f(shading.sun->irradiance) * at.visible;
}

const Corners& corners_at(const VertexShading& shading, std::size_t layer, int x, int y) {
  return shading.mesh.triangles[shading.view.hit(layer, x, y).triangle];
}

std::array<float, 3> weights_of(const PrimaryHit& hit) { return {1 - hit.u - hit.v, hit.u, hit.v}; }

}  // namespace

void add_matt(const VertexShading& shading, std::size_t layer, int x, int y, float share,
              std::size_t place, TileImage& image) {
  const auto add = [&](const Vec3f& radiance) {
    for (std::size_t c = 0; c < 3; ++c) image.channel[c][place] += radiance[static_cast<int>(c)];
  };
  const Corners& corners = corners_at(shading, layer, x, y);
  const std::array<float, 3> weights = weights_of(shading.view.hit(layer, x, y));
  const auto& diffuse = shading.diffuse;
  const Vec3f radiance = diffuse[corners[0]] * weights[0] + diffuse[corners[1]] * weights[1] +
                         diffuse[corners[2]] * weights[2];
  add(radiance * share);
  if (shading.sun != nullptr) add(sunlight(shading, layer, x, y, corners, weights) * share);
}

bool has_highlight(const VertexShading& shading, std::size_t layer, int x, int y) {
  const std::uint32_t material = shading.mesh.materials[corners_at(shading, layer, x, y)[0]];
  return shading.materials.has_highlight(material) && shading.view.has_highlight(layer, x, y);
}

const VertexMaterial& material_at(const VertexShading& shading, std::size_t layer, int x, int y) {
  return shading.materials.at(shading.mesh.materials[corners_at(shading, layer, x, y)[0]]);
}

HighlightBatch& HighlightBatch::of_thread(const VertexShading& shading) {
  thread_local HighlightBatch batch;
  const std::size_t count = sh::coefficient_count(shading.visibility_degree);
  batch.panel_.resize(count * kPixels);
  batch.rows_.resize(shading.lighting.stride() * kPixels);
  batch.clear();
  return batch;
}

void HighlightBatch::add(const VertexShading& shading, std::size_t layer, int x, int y,
                         std::uint32_t tag) {
  const Corners& corners = corners_at(shading, layer, x, y);
  const Vec3f& way = shading.view.mirrored(layer, x, y);
  const std::size_t i = count_++;
  x_[i] = way.x;
  y_[i] = way.y;
  z_[i] = way.z;
  MirroringPoint& point = points_[i];
  for (std::size_t k = 0; k < 3; ++k) point.corners[k] = shading.lighting.incident(corners[k]);
  point.weights = weights_of(shading.view.hit(layer, x, y));
  point.lobe = shading.materials.lobe(shading.mesh.materials[corners[0]]);
  tags_[i] = tag;
}

void HighlightBatch::evaluate(const VertexShading& shading) {
  const std::size_t padded = sh::padded(count_);
  const std::size_t stride = shading.lighting.stride();
  std::fill(x_.begin() + static_cast<std::ptrdiff_t>(count_),
            x_.begin() + static_cast<std::ptrdiff_t>(padded), 1.0f);
  sh::evaluate(
      {std::span(x_).first(padded), std::span(y_).first(padded), std::span(z_).first(padded)},
      shading.visibility_degree, panel_, kPixels);
  transpose_panel(panel_.data(), sh::coefficient_count(shading.visibility_degree), rows_.data(),
                  stride);
  gather_lobes(std::span(points_).first(count_), rows_.data(), stride, radiance_.data());
}

}  // namespace rimlight
