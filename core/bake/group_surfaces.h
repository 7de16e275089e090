#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/bake/group.h"
#include "core/bake/lane_set.h"
#include "core/bake/surface_groups.h"
#include "core/bake/texel_quadrature.h"
#include "core/base/aligned_vector.h"

namespace rimlight {

/// One number for each lane, ready for vector code.
template <typename T>
struct alignas(64) LaneArray {
  std::array<T, kGroupLanes> lane{};
  T& operator[](std::size_t i) { return lane[i]; }
  T operator[](std::size_t i) const { return lane[i]; }
  const T* data() const { return lane.data(); }
};
/// [x, y, z][lane].
using LaneVectors = std::array<LaneArray<float>, 3>;

/// Layer l holds the l-th surface of each lane that has so many; lanes without one stay blank.
struct SurfaceLayer {
  LaneSet lanes = 0;  // that have a surface
  /// Four hits spread over the surface stand for all when its response is evaluated, one for each
  /// quarter of a texel.
  std::array<LaneVectors, kQuarters> shading_normal;
  std::array<LaneVectors, kQuarters> geometric_normal;
  /// Lambert surfaces: share · albedo / π by channel. The others: 0.
  std::array<LaneArray<float>, 3> lambert;
  /// The others, and where GroupSurfaces keeps them.
  LaneSet lobe_lanes = 0;
  LaneArray<std::int32_t> lobe;
  /// A surface's hits: hit_count of them (blank: 1) from first_hit of GroupSurfaces::hits. A walk
  /// in steps of hit_step, modulo hit_count, visits far ones first, and all in the end.
  LaneArray<std::int32_t> first_hit, hit_count, hit_step;
};

/// A surface whose BRDF depends on both directions.
struct LobeSurface {
  Brdf brdf;
  float share = 0;
  // Of the four hits that stand for all.
  std::array<Frame<float>, kQuarters> frame;
  std::array<Vec3f, kQuarters> geometric_normal;
  std::array<Vec3f, kQuarters> outgoing;  // local to the frame
};

/// The hit of a surface that stands for it in a quarter of each texel.
std::size_t standing_hit(const PixelSurface& surface, std::size_t quarter);

LobeSurface lobe_surface(const PixelSurface& surface);

/// What rays to the sky need of the hits of all surfaces: one array a component.
class HitTable {
 public:
  /// The first components of what there is of a hit; vectors have three. The origin is where rays
  /// start on the side of the geometric normal: offset · normal clear of the surface.
  static constexpr std::size_t kOrigin = 0, kGeometricNormal = 3, kShadingNormal = 6, kOffset = 9;
  static constexpr std::size_t kComponents = 10;

  void clear() { count_ = 0; }
  /// Room for `count` hits and a blank one.
  void reserve(std::size_t count);
  void add(const SurfaceHit& hit);
  std::size_t size() const { return count_; }
  /// [size()]
  const float* component(std::size_t i) const { return values_.data() + i * room_; }

 private:
  AlignedVector<float> values_;  // [component][room]
  std::size_t room_ = 0;
  std::size_t count_ = 0;
};

/// Some of a scene's materials: [material], or all when it is empty.
class MaterialSet {
 public:
  MaterialSet() = default;
  explicit MaterialSet(std::vector<bool> materials) : materials_(std::move(materials)) {}

  bool has(std::uint32_t material) const { return materials_.empty() || materials_[material]; }
  /// The others. Of all: all.
  MaterialSet others() const {
    MaterialSet result = *this;
    result.materials_.flip();
    return result;
  }

 private:
  std::vector<bool> materials_;
};

/// The surfaces of a group's pixels as vector code reads them. Reused from group to group, so that
/// it stops allocating. One thread at a time.
class GroupSurfaces {
 public:
  /// Finds the surfaces of `samples`: all, or those of some materials.
  void assign(const GroupSamples& samples, const MaterialSet& materials = {});

  std::size_t layer_count() const { return layer_count_; }
  const SurfaceLayer& layer(std::size_t i) const { return layers_[i]; }
  /// Of a lane of the layer's lobe_lanes.
  const LobeSurface& lobe(std::size_t layer, std::size_t lane) const {
    return lobes_[static_cast<std::size_t>(layers_[layer].lobe[lane])];
  }
  const HitTable& hits() const { return hits_; }
  /// Of the pixels that have any.
  float surfaces_per_pixel() const;

 private:
  void add(const PixelSurface& surface, std::size_t lane, std::size_t layer);

  std::array<SurfaceLayer, kMostSurfaces> layers_;
  std::size_t layer_count_ = 0;
  std::vector<LobeSurface> lobes_;
  HitTable hits_;
  PixelSurfaces found_;
};

}  // namespace rimlight
