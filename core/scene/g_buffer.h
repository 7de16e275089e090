#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/math/camera.h"

namespace rimlight {

/// What a camera ray meets first: a point of a triangle, w · corner 0 + u · corner 1 + v · corner 2
/// with w = 1 − u − v.
struct PrimaryHit {
  static constexpr std::uint32_t kMiss = 0xffffffffu;

  std::uint32_t triangle = kMiss;
  float u = 0, v = 0;

  bool is_miss() const { return triangle == kMiss; }
};

/// The triangles of one mesh in Embree, ready for camera rays. The tree is built by one thread, so
/// that the same mesh gives the same hits. Triangles without area are never hit. Immutable; any
/// thread.
class TriangleTree {
 public:
  /// Throws Error, naming `name`, when a position is not finite, a corner is no position, or Embree
  /// cannot take the mesh. Copies what it needs.
  TriangleTree(std::span<const Vec3f> positions,
               std::span<const std::array<std::uint32_t, 3>> triangles, const std::string& name);
  ~TriangleTree();

  static constexpr std::size_t kPacketRays = 16;
  /// Rays of one packet, from one origin: directions of any length but zero.
  struct Packet {
    Vec3f origin;
    alignas(64) std::array<float, kPacketRays> x, y, z;
  };
  /// The nearest hits of a packet's rays, on either side of the triangles.
  void intersect(const Packet& packet, std::span<PrimaryHit, kPacketRays> hits) const;

  /// Where some parallel rays start: the first `count`, at most kPacketRays.
  struct ShadowPacket {
    std::size_t count = 0;
    alignas(64) std::array<float, kPacketRays> x, y, z;

    void add(const Vec3f& origin) {
      x[count] = origin.x;
      y[count] = origin.y;
      z[count] = origin.z;
      ++count;
    }
  };
  /// For each ray of a packet whether a triangle is in its way to infinity, as bits. The direction
  /// is of any length but zero.
  std::uint32_t occluded(const ShadowPacket& packet, const Vec3f& direction) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Which pixels have been traced: none, every second one both ways (those of even x and y), all.
enum class GBufferDetail { none, coarse, full };

/// A point of the pixel, from its upper left corner: x right, y down, in [0, 1).
struct PixelPoint {
  double x = 0.5, y = 0.5;
};

/// The primary hits of one ray through each pixel, kept while the camera stands still. Rays go in
/// packets of fixed pixels (4 × 4 of like parity), so that hits have the same bits at any number of
/// threads and whether a coarse pass came before the full one or not. One thread at a time;
/// computes on all cores; allocates nothing after it is made.
class GBuffer {
 public:
  /// width, height: 1 … 16384, else CheckFailure.
  GBuffer(std::shared_ptr<const TriangleTree> tree, int width, int height, PixelPoint point = {});

  /// Traces what is missing of `detail`, all when the camera is another than before. The camera has
  /// passed check_camera(). True when anything was traced.
  bool trace(const Camera& camera, GBufferDetail detail);

  int width() const { return width_; }
  int height() const { return height_; }
  PixelPoint point() const { return point_; }
  GBufferDetail detail() const { return detail_; }
  /// The hit of a pixel that detail() includes.
  const PrimaryHit& at(int x, int y) const {
    return hits_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                 static_cast<std::size_t>(x)];
  }

 private:
  struct Parity {
    int x, y;
  };
  void trace_tile(const CameraRays& rays, std::size_t tile, std::span<const Parity> parities);
  void trace_packet(const CameraRays& rays, int left, int top, Parity parity);

  std::shared_ptr<const TriangleTree> tree_;
  int width_, height_;
  PixelPoint point_;
  std::optional<Camera> camera_;
  GBufferDetail detail_ = GBufferDetail::none;
  std::vector<PrimaryHit> hits_;  // [height][width]
};

}  // namespace rimlight
