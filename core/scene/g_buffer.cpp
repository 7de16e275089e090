#include "core/scene/g_buffer.h"

#include <algorithm>
#include <limits>
#include <string>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/scene/embree_tree.h"

namespace rimlight {
namespace {

constexpr int kLargestSide = 16384;
constexpr int kTileSide = 64;   // pixels: the unit of parallel work
constexpr int kBlockSide = 8;   // pixels: four packets, one of each parity
constexpr int kPacketSide = 4;  // rays
static_assert(kPacketSide * kPacketSide == TriangleTree::kPacketRays);

int tiles_along(int pixels) { return (pixels + kTileSide - 1) / kTileSide; }

void check_mesh(std::span<const Vec3f> positions,
                std::span<const std::array<std::uint32_t, 3>> triangles, const std::string& name) {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!is_finite(positions[i])) {
      throw Error(name + ": position " + std::to_string(i), "a number that is not finite",
                  "finite numbers");
    }
  }
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::uint32_t last = std::max({triangles[i][0], triangles[i][1], triangles[i][2]});
    if (last >= positions.size()) {
      throw Error(name + ": triangle " + std::to_string(i), "corner " + std::to_string(last),
                  "less than " + std::to_string(positions.size()));
    }
  }
}

}  // namespace

struct TriangleTree::State {
  embree::DevicePtr device;
  embree::ScenePtr tree;
};

TriangleTree::TriangleTree(std::span<const Vec3f> positions,
                           std::span<const std::array<std::uint32_t, 3>> triangles,
                           const std::string& name)
    : state_(std::make_unique<State>()) {
  check_mesh(positions, triangles, name);
  flush_denormals();
  state_->device = embree::new_device();
  RTCDevice const device = state_->device.get();
  state_->tree.reset(rtcNewScene(device));
  embree::check_device(device, name);
  rtcSetSceneBuildQuality(state_->tree.get(), RTC_BUILD_QUALITY_HIGH);
  embree::attach_triangles(device, state_->tree.get(), {positions, triangles}, 0);
  embree::check_device(device, name);
  embree::commit_alone(state_->tree.get());
  embree::check_device(device, name);
}

TriangleTree::~TriangleTree() = default;

void TriangleTree::intersect(const Packet& packet, std::span<PrimaryHit, kPacketRays> hits) const {
  alignas(64) static constexpr auto kAll = [] {
    std::array<int, kPacketRays> all{};
    all.fill(-1);
    return all;
  }();
  RTCRayHit16 query{};
  for (std::size_t i = 0; i < kPacketRays; ++i) {
    query.ray.org_x[i] = packet.origin.x;
    query.ray.org_y[i] = packet.origin.y;
    query.ray.org_z[i] = packet.origin.z;
    query.ray.dir_x[i] = packet.x[i];
    query.ray.dir_y[i] = packet.y[i];
    query.ray.dir_z[i] = packet.z[i];
    query.ray.tfar[i] = std::numeric_limits<float>::infinity();
    query.ray.mask[i] = 0xffffffffu;
    query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect16(kAll.data(), state_->tree.get(), &context, &query);
  for (std::size_t i = 0; i < kPacketRays; ++i) {
    const bool missed = query.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID;
    hits[i] =
        missed ? PrimaryHit{} : PrimaryHit{query.hit.primID[i], query.hit.u[i], query.hit.v[i]};
  }
}

std::uint32_t TriangleTree::occluded(const ShadowPacket& packet, const Vec3f& direction) const {
  alignas(64) std::array<int, kPacketRays> valid{};
  RTCRay16 query{};
  for (std::size_t i = 0; i < packet.count; ++i) {
    valid[i] = -1;
    query.org_x[i] = packet.x[i];
    query.org_y[i] = packet.y[i];
    query.org_z[i] = packet.z[i];
    query.dir_x[i] = direction.x;
    query.dir_y[i] = direction.y;
    query.dir_z[i] = direction.z;
    query.tfar[i] = std::numeric_limits<float>::infinity();
    query.mask[i] = 0xffffffffu;
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcOccluded16(valid.data(), state_->tree.get(), &context, &query);
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < packet.count; ++i) {
    if (query.tfar[i] < 0) bits |= std::uint32_t{1} << i;  // minus infinity
  }
  return bits;
}

GBuffer::GBuffer(std::shared_ptr<const TriangleTree> tree, int width, int height, PixelPoint point)
    : tree_(std::move(tree)), width_(width), height_(height), point_(point) {
  RIMLIGHT_CHECK(tree_ != nullptr);
  RIMLIGHT_CHECK(width >= 1 && width <= kLargestSide && height >= 1 && height <= kLargestSide);
  hits_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
}

bool GBuffer::trace(const Camera& camera, GBufferDetail detail) {
  if (camera_ != camera) {
    camera_ = camera;
    detail_ = GBufferDetail::none;
  }
  if (detail <= detail_) return false;
  constexpr Parity kParities[] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
  const std::size_t first = detail_ == GBufferDetail::none ? 0 : 1;
  const std::size_t end = detail == GBufferDetail::full ? 4 : 1;
  const auto parities = std::span(kParities).subspan(first, end - first);
  const CameraRays rays(camera, width_, height_);
  const auto tiles = static_cast<std::size_t>(tiles_along(width_)) *
                     static_cast<std::size_t>(tiles_along(height_));
  parallel_for(tiles, [&](std::size_t tile) { trace_tile(rays, tile, parities); });
  detail_ = detail;
  return true;
}

void GBuffer::trace_tile(const CameraRays& rays, std::size_t tile,
                         std::span<const Parity> parities) {
  const int across = tiles_along(width_);
  const int left = static_cast<int>(tile) % across * kTileSide;
  const int top = static_cast<int>(tile) / across * kTileSide;
  for (int y = top; y < std::min(top + kTileSide, height_); y += kBlockSide) {
    for (int x = left; x < std::min(left + kTileSide, width_); x += kBlockSide) {
      for (const Parity& parity : parities) trace_packet(rays, x, y, parity);
    }
  }
}

void GBuffer::trace_packet(const CameraRays& rays, int left, int top, Parity parity) {
  TriangleTree::Packet packet;
  packet.origin = Vec3f(rays.origin());
  const auto pixel = [&](std::size_t i) {
    return Parity{left + parity.x + 2 * (static_cast<int>(i) % kPacketSide),
                  top + parity.y + 2 * (static_cast<int>(i) / kPacketSide)};
  };
  for (std::size_t i = 0; i < TriangleTree::kPacketRays; ++i) {
    const Parity at = pixel(i);
    // Those beyond the image are traced too, and dropped: they are few.
    const Vec3f way(rays.direction(at.x + point_.x, at.y + point_.y));
    packet.x[i] = way.x;
    packet.y[i] = way.y;
    packet.z[i] = way.z;
  }
  std::array<PrimaryHit, TriangleTree::kPacketRays> hits;
  tree_->intersect(packet, hits);
  for (std::size_t i = 0; i < TriangleTree::kPacketRays; ++i) {
    const Parity at = pixel(i);
    if (at.x >= width_ || at.y >= height_) continue;
    hits_[static_cast<std::size_t>(at.y) * static_cast<std::size_t>(width_) +
          static_cast<std::size_t>(at.x)] = hits[i];
  }
}

}  // namespace rimlight
