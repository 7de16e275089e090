#include "core/vertices/sun_shadows.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/math/sampling.h"

namespace rimlight {
namespace {

constexpr int kTileSide = 64;   // pixels: the unit of parallel work
constexpr int kPacketSide = 4;  // rays
constexpr std::size_t kRays = TriangleTree::kPacketRays;
static_assert(kPacketSide * kPacketSide == kRays);
/// Interpolated normals shorter than this point nowhere.
constexpr float kLeastSquare = 1e-12f;
/// A hit's position is off by a few 2⁻²⁴ of the triangle's coordinates; this clears it by far.
constexpr float kOffsetScale = 0x1p-16f;

int tiles_along(int pixels) { return (pixels + kTileSide - 1) / kTileSide; }

float largest(const Vec3f& v) {
  return max_component(Vec3f(std::abs(v.x), std::abs(v.y), std::abs(v.z)));
}

/// Of a point below the tangent plane at a corner, the way up to it.
Vec3f way_to_plane(const Vec3f& point, const Vec3f& corner, const Vec3f& normal) {
  return normal * -std::min(0.0f, dot(point - corner, normal));
}

struct StartingPoint {
  Vec3f position;
  Vec3f normal;  // unit, or zero where there is none
};

StartingPoint starting_point(const VertexMesh& mesh, const PrimaryHit& hit) {
  const auto& [a, b, c] = mesh.triangles[hit.triangle];
  const Vec3f &pa = mesh.positions[a], &pb = mesh.positions[b], &pc = mesh.positions[c];
  const Vec3f &na = mesh.normals[a], &nb = mesh.normals[b], &nc = mesh.normals[c];
  const float u = hit.u, v = hit.v, w = 1 - u - v;
  StartingPoint start;
  const Vec3f normal = na * w + nb * u + nc * v;
  const float square = dot(normal, normal);
  if (!(square > kLeastSquare)) return start;
  start.normal = normal * (1 / std::sqrt(square));
  const Vec3f flat = pa * w + pb * u + pc * v;
  start.position = flat + way_to_plane(flat, pa, na) * w + way_to_plane(flat, pb, nb) * u +
                   way_to_plane(flat, pc, nc) * v;
  const float size = std::max({largest(pa), largest(pb), largest(pc)});
  start.position += start.normal * (size * kOffsetScale);
  return start;
}

/// Directions over the sun's disc.
std::vector<Vec3f> sun_directions(const Sun& sun, int rays, std::size_t layer) {
  if (rays == 1) return {Vec3f(sun.direction)};
  const Frame<double> frame(sun.direction);
  const double radius = std::tan(sun.angular_radius);
  std::vector<Vec3f> directions;
  for (int i = 0; i < rays; ++i) {
    // Points of one sequence through all layers: together they cover the disc more finely.
    const DiscPoint at = uniform_disc(r2_point({0.5, 0.5}, static_cast<int>(layer) * rays + i));
    directions.emplace_back(frame.to_world({at.x * radius, at.y * radius, 1}));
  }
  return directions;
}

}  // namespace

/// Shadow rays from the points of one layer.
struct SunShadows::Tracer {
  const VertexMesh& mesh;
  const TriangleTree& tree;
  const VertexView& view;
  std::size_t layer;
  Vec3f sun;
  std::vector<Vec3f> directions;
  std::span<SunAtPoint> points;

  void trace_tile(int left, int top) const {
    const int step = view.step(), side = 2 * kPacketSide;
    const int right = std::min(left + kTileSide, view.width());
    const int bottom = std::min(top + kTileSide, view.height());
    for (int y = top; y < bottom; y += side) {
      for (int x = left; x < right; x += side) {
        // Packets of pixels of like parity, so that a coarse view has the bits of a full one.
        trace_packet(x, y);
        if (step > 1) continue;
        trace_packet(x + 1, y);
        trace_packet(x, y + 1);
        trace_packet(x + 1, y + 1);
      }
    }
  }

  void trace_packet(int left, int top) const {
    TriangleTree::ShadowPacket packet;
    packet.count = 0;
    std::array<SunAtPoint*, kRays> targets{};
    for (int i = 0; i < static_cast<int>(kRays); ++i) {
      const int x = left + 2 * (i % kPacketSide), y = top + 2 * (i / kPacketSide);
      if (x >= view.width() || y >= view.height()) continue;
      SunAtPoint& point =
          points[static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width()) +
                 static_cast<std::size_t>(x)];
      point = {};
      const PrimaryHit& hit = view.hit(layer, x, y);
      if (hit.is_miss()) continue;
      const StartingPoint start = starting_point(mesh, hit);
      point.cosine = std::max(0.0f, dot(start.normal, sun));
      if (!(point.cosine > 0)) continue;
      targets[packet.count] = &point;
      packet.add(start.position);
    }
    if (packet.count == 0) return;
    const float share = 1.0f / static_cast<float>(directions.size());
    for (const Vec3f& direction : directions) {
      const std::uint32_t occluded = tree.occluded(packet, direction);
      for (std::size_t k = 0; k < packet.count; ++k) {
        if (((occluded >> k) & 1) == 0) targets[k]->visible += share;
      }
    }
  }
};

SunShadows::SunShadows(const VertexMesh& mesh, std::shared_ptr<const TriangleTree> tree, int rays)
    : mesh_(mesh), tree_(std::move(tree)), rays_(rays) {
  RIMLIGHT_CHECK(tree_ != nullptr && rays >= 1);
}

void SunShadows::find(const VertexView& view, const Sun& sun, bool view_changed) {
  if (!view_changed && sun_ == sun) return;
  sun_ = sun;
  layers_.resize(view.layer_count());
  const auto across = static_cast<std::size_t>(tiles_along(view.width()));
  const auto down = static_cast<std::size_t>(tiles_along(view.height()));
  for (std::size_t layer = 0; layer < layers_.size(); ++layer) {
    layers_[layer].resize(static_cast<std::size_t>(view.width()) *
                          static_cast<std::size_t>(view.height()));
    const Tracer tracer{
        mesh_,         *tree_, view, layer, Vec3f(sun.direction), sun_directions(sun, rays_, layer),
        layers_[layer]};
    parallel_for(across * down, [&](std::size_t tile) {
      tracer.trace_tile(static_cast<int>(tile % across) * kTileSide,
                        static_cast<int>(tile / across) * kTileSide);
    });
  }
}

}  // namespace rimlight
