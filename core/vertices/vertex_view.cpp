#include "core/vertices/vertex_view.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "core/base/parallel.h"

namespace rimlight {
namespace {

/// Rows of one piece of parallel work.
constexpr int kRows = 16;
/// Interpolated normals shorter than this point nowhere.
constexpr float kLeastSquare = 1e-12f;

/// What is at a hit.
struct SurfacePoint {
  Vec3f position;
  Vec3f normal;  // interpolated, not unit
  bool from_behind = false;
};

SurfacePoint surface_at(const VertexMesh& mesh, const PrimaryHit& hit, const Vec3f& way) {
  const auto& [a, b, c] = mesh.triangles[hit.triangle];
  SurfacePoint point;
  point.position = mesh.positions[a] * (1 - hit.u - hit.v) + mesh.positions[b] * hit.u +
                   mesh.positions[c] * hit.v;
  point.normal =
      mesh.normals[a] * (1 - hit.u - hit.v) + mesh.normals[b] * hit.u + mesh.normals[c] * hit.v;
  // The side is the triangle's: at a silhouette an interpolated normal may look away from the eye.
  const Vec3f plane =
      cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
  point.from_behind = (dot(plane, way) > 0) != (dot(plane, point.normal) < 0);
  return point;
}

}  // namespace

VertexView::VertexView(const VertexMesh& mesh, std::shared_ptr<const TriangleTree> tree,
                       const Settings& settings)
    : mesh_(mesh),
      width_(settings.width),
      height_(settings.height),
      highlight_count_(settings.highlight_count),
      needed_(mesh.positions.size()) {
  const std::size_t pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  for (const PixelPoint& point : settings.points) {
    layers_.push_back({GBuffer(tree, width_, height_, point),
                       std::vector<Vec3f>(highlight_count_ > 0 ? pixels : 0),
                       std::vector<float>(highlight_count_ > 0 ? pixels : 0)});
  }
  coverage_.resize(pixels);
}

GBufferDetail VertexView::detail_of(const Camera& camera) const {
  return camera == camera_ ? detail_ : GBufferDetail::none;
}

double VertexView::depth_of_pixel() const {
  const double half = 0.5 * camera_.vertical_field_of_view_degrees * std::numbers::pi / 180;
  return 2 * std::tan(half) / height_;
}

bool VertexView::look(const Camera& camera, GBufferDetail detail) {
  if (detail_of(camera) >= detail) return false;
  camera_ = camera;
  detail_ = detail;
  std::ranges::fill(needed_, std::uint8_t{0});
  const CameraRays rays(camera, width_, height_);
  Counts all;
  for (Layer& layer : layers_) {
    layer.hits.trace(camera, detail);
    std::vector<Counts> counts(static_cast<std::size_t>((height_ + kRows - 1) / kRows));
    parallel_for(counts.size(), [&](std::size_t chunk) {
      const int first = static_cast<int>(chunk) * kRows;
      for (int y = first; y < std::min(first + kRows, height_); y += step()) {
        const Counts row = read_row(layer, rays, y);
        counts[chunk].hits += row.hits;
        counts[chunk].from_behind += row.from_behind;
      }
    });
    for (const Counts& one : counts) {
      all.hits += one.hits;
      all.from_behind += one.from_behind;
    }
  }
  share_from_behind_ =
      all.hits == 0 ? 0 : static_cast<double>(all.from_behind) / static_cast<double>(all.hits);
  find_coverage();
  find_vertices();
  return true;
}

VertexView::Counts VertexView::read_row(Layer& layer, const CameraRays& rays, int y) {
  Counts counts;
  const PixelPoint point = layer.hits.point();
  for (int x = 0; x < width_; x += step()) {
    const PrimaryHit& hit = layer.hits.at(x, y);
    if (highlight_count_ > 0) layer.mirrored[index(x, y)] = {};
    if (hit.is_miss()) continue;
    ++counts.hits;
    const auto& corners = mesh_.triangles[hit.triangle];
    for (const std::uint32_t corner : corners) {
      // Threads may write the same 1.
      std::atomic_ref(needed_[corner]).store(1, std::memory_order_relaxed);
    }
    const Vec3f way(rays.direction(x + point.x, y + point.y));
    const SurfacePoint surface = surface_at(mesh_, hit, way);
    if (surface.from_behind) ++counts.from_behind;
    const float square = dot(surface.normal, surface.normal);
    if (surface.from_behind || !(square > kLeastSquare) ||
        std::max({corners[0], corners[1], corners[2]}) >= highlight_count_) {
      continue;
    }
    layer.mirrored[index(x, y)] = way - surface.normal * (2 * dot(way, surface.normal) / square);
    layer.distances[index(x, y)] = dot(surface.position - Vec3f(camera_.position), way);
  }
  return counts;
}

void VertexView::find_coverage() {
  const float share = 1.0f / static_cast<float>(layers_.size());
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const int known_x = x - x % step(), known_y = y - y % step();
      int hits = 0;
      for (const Layer& layer : layers_) hits += layer.hits.at(known_x, known_y).is_miss() ? 0 : 1;
      coverage_[index(x, y)] = static_cast<float>(hits) * share;
    }
  }
}

void VertexView::find_vertices() {
  vertices_.clear();
  for (std::size_t i = 0; i < needed_.size(); ++i) {
    if (needed_[i] != 0) vertices_.push_back(static_cast<std::uint32_t>(i));
  }
}

std::span<const std::uint32_t> VertexView::highlight_vertices() const {
  const auto end = std::ranges::lower_bound(vertices_, highlight_count_);
  return std::span(vertices_).first(static_cast<std::size_t>(end - vertices_.begin()));
}

}  // namespace rimlight
