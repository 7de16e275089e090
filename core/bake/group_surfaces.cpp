#include "core/bake/group_surfaces.h"

#include <bit>
#include <numbers>
#include <numeric>

#include "core/base/check.h"

namespace rimlight {
namespace {

void set_lane(LaneVectors& vectors, std::size_t lane, const Vec3f& value) {
  for (int c = 0; c < 3; ++c) vectors[static_cast<std::size_t>(c)][lane] = value[c];
}

/// Without a common divisor, so that the walk visits all.
std::int32_t walk_step(std::int32_t hit_count) {
  std::int32_t step = 7;
  while (std::gcd(step, hit_count) != 1) ++step;
  return step % hit_count;
}

}  // namespace

std::size_t standing_hit(const PixelSurface& surface, std::size_t quarter) {
  return (2 * quarter + 1) * surface.hits.size() / (2 * kQuarters);
}

LobeSurface lobe_surface(const PixelSurface& surface) {
  const auto frame = [&](std::size_t quarter) {
    return surface.hits[standing_hit(surface, quarter)]->frame();
  };
  static_assert(kQuarters == 4);
  LobeSurface result{surface.brdf, surface.share, {frame(0), frame(1), frame(2), frame(3)}, {}, {}};
  for (std::size_t q = 0; q < kQuarters; ++q) {
    const std::size_t hit = standing_hit(surface, q);
    result.geometric_normal[q] = surface.hits[hit]->geometric_normal;
    result.outgoing[q] = result.frame[q].to_local(surface.outgoing[hit]);
  }
  return result;
}

void HitTable::reserve(std::size_t count) {
  RIMLIGHT_CHECK_EQ(count_, 0u);
  // Not a multiple of a page, which would put one hit's components into one set of the cache.
  room_ = count + 16;
  if (values_.size() < kComponents * room_) values_.resize(kComponents * room_);
}

void HitTable::add(const SurfaceHit& hit) {
  RIMLIGHT_CHECK(count_ < room_);
  const Vec3f& g = hit.geometric_normal;
  const Vec3f o = RayScene::ray_origin(hit, g);
  const Vec3f& s = hit.shading_normal;
  float* value = values_.data() + count_;
  for (const float one : {o.x, o.y, o.z, g.x, g.y, g.z, s.x, s.y, s.z, hit.offset}) {
    *value = one;
    value += room_;
  }
  ++count_;
}

void GroupSurfaces::assign(const GroupSamples& samples, const MaterialSet& materials) {
  layer_count_ = 0;
  lobes_.clear();
  hits_.clear();
  hits_.reserve(samples.hits.size());
  for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
    find_surfaces(samples, lane, found_);
    std::size_t layer = 0;
    for (const PixelSurface& surface : found_) {
      if (materials.has(surface.material)) add(surface, lane, layer++);
    }
  }
}

float GroupSurfaces::surfaces_per_pixel() const {
  int surfaces = 0;
  for (std::size_t i = 0; i < layer_count_; ++i) surfaces += std::popcount(layers_[i].lanes);
  const int pixels = layer_count_ > 0 ? std::popcount(layers_[0].lanes) : 1;
  return static_cast<float>(surfaces) / static_cast<float>(pixels);
}

void GroupSurfaces::add(const PixelSurface& surface, std::size_t lane, std::size_t layer) {
  if (layer == layer_count_) {
    SurfaceLayer blank;
    blank.hit_count.lane.fill(1);
    layers_[layer_count_++] = blank;
  }
  SurfaceLayer& to = layers_[layer];
  to.lanes |= lane_bit(lane);
  for (std::size_t q = 0; q < kQuarters; ++q) {
    const SurfaceHit& hit = *surface.hits[standing_hit(surface, q)];
    set_lane(to.shading_normal[q], lane, hit.shading_normal);
    set_lane(to.geometric_normal[q], lane, hit.geometric_normal);
  }
  if (surface.brdf.model == BrdfModel::lambert) {
    const float scale = surface.share * std::numbers::inv_pi_v<float>;
    set_lane(to.lambert, lane, surface.brdf.albedo * scale);
  } else {
    to.lobe_lanes |= lane_bit(lane);
    to.lobe[lane] = static_cast<std::int32_t>(lobes_.size());
    lobes_.push_back(lobe_surface(surface));
  }
  to.first_hit[lane] = static_cast<std::int32_t>(hits_.size());
  to.hit_count[lane] = static_cast<std::int32_t>(surface.hits.size());
  to.hit_step[lane] = walk_step(to.hit_count[lane]);
  for (const SurfaceHit* hit : surface.hits) hits_.add(*hit);
}

}  // namespace rimlight
