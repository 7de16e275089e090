#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/basis/cube_map.h"
#include "core/scene/ray_scene.h"
#include "core/transport/receivers.h"

namespace rimlight {

/// A group is 8×8 pixels, baked together: 64 receivers, here called lanes, in the order of
/// PixelLayout (blocks of 4×2 pixels). Three channels of 64 lanes are one row entry.
inline constexpr std::size_t kGroupLanes = PixelLayout::kGroupReceivers;
inline constexpr std::size_t kRowLanes = 3 * kGroupLanes;

/// Dense transport of one group: [texel or coefficient][channel][lane], float. A texel's value is
/// the integral of the transport over it (CubeHaar's convention).
struct GroupRows {
  explicit GroupRows(int cube_size_)
      : cube_size(cube_size_), values(cube::texel_count(cube_size_) * kRowLanes) {}

  int cube_size;
  AlignedVector<float> values;

  float* row(std::size_t texel) { return values.data() + texel * kRowLanes; }
  const float* row(std::size_t texel) const { return values.data() + texel * kRowLanes; }
};

/// What the camera sees through a group's pixels: `rays` jittered primary rays each.
struct GroupSamples {
  int rays = 0;
  std::vector<std::optional<SurfaceHit>> hits;  // [lane][ray]; nothing: the ray left the scene
  std::vector<Vec3f> outgoing;  // [lane][ray], unit, from the hit towards the camera

  const std::optional<SurfaceHit>& hit(std::size_t lane, int ray) const {
    return hits[lane * static_cast<std::size_t>(rays) + static_cast<std::size_t>(ray)];
  }
  const Vec3f& out(std::size_t lane, int ray) const {
    return outgoing[lane * static_cast<std::size_t>(rays) + static_cast<std::size_t>(ray)];
  }
  bool empty() const;
  /// Share of a lane's rays that hit something: the pixel's coverage.
  float coverage(std::size_t lane) const;
};

/// Traces a group's primary rays. `first_receiver` is the group's first receiver in `layout`; lanes
/// outside the image have no hits. Each pixel's jitter is an R2 sequence with a seeded shift (box
/// filter), so the result depends on scene, seed and receiver alone.
void sample_group(const RayScene& scene, const PixelLayout& layout, std::size_t first_receiver,
                  int rays, std::uint64_t seed, GroupSamples& samples);

}  // namespace rimlight
