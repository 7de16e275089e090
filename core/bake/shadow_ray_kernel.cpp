#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/bake/shadow_ray_kernel.cpp"
#include "core/bake/shadow_ray_kernel.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <bit>

#include "core/base/check.h"

HWY_BEFORE_NAMESPACE();
namespace rimlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// 64 lanes are a whole number of vectors, and a vector is within SkyRays::kSlack.
using Floats = hn::CappedTag<float, SkyRays::kSlack>;
using Ints = hn::RebindToSigned<Floats>;
using Bits = hn::RebindToUnsigned<Floats>;
using FloatVector = hn::Vec<Floats>;
using IntVector = hn::Vec<Ints>;
using BitVector = hn::Vec<Bits>;

struct VectorOf3 {
  FloatVector x, y, z;
};

HWY_INLINE FloatVector dot(const VectorOf3& a, const VectorOf3& b) {
  return hn::MulAdd(a.z, b.z, hn::MulAdd(a.y, b.y, hn::Mul(a.x, b.x)));
}

HWY_INLINE VectorOf3 spread(const Vec3f& v) {
  const Floats f32;
  return {hn::Set(f32, v.x), hn::Set(f32, v.y), hn::Set(f32, v.z)};
}

/// a + b · s
HWY_INLINE VectorOf3 mul_add(const VectorOf3& b, FloatVector s, const VectorOf3& a) {
  return {hn::MulAdd(b.x, s, a.x), hn::MulAdd(b.y, s, a.y), hn::MulAdd(b.z, s, a.z)};
}

HWY_INLINE VectorOf3 select(hn::Mask<Floats> mask, const VectorOf3& yes, const VectorOf3& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y),
          hn::IfThenElse(mask, yes.z, no.z)};
}

/// [0, 2³²) to [0, 1): 24 bits, so that it never rounds up to 1.
HWY_INLINE FloatVector fraction(BitVector bits) {
  const Floats f32;
  const auto high = hn::BitCast(Ints(), hn::ShiftRight<8>(bits));
  return hn::Mul(hn::ConvertTo(f32, high), hn::Set(f32, 0x1p-24f));
}

/// Numbers of the lanes in `lane`.
HWY_INLINE IntVector pick(const LaneArray<std::int32_t>& numbers, IntVector lane) {
  return hn::GatherIndex(Ints(), numbers.data(), lane);
}

/// The points of the texel and the hits that rays go to and come from.
struct Ends {
  FloatVector u, v;
  IntVector hit;
};

HWY_INLINE void mix(BitVector& x, BitVector& y, BitVector& z) {
  x = hn::Add(x, hn::Mul(y, z));
  y = hn::Add(y, hn::Mul(z, x));
  z = hn::Add(z, hn::Mul(x, y));
}

/// A number below `count`, from 32 random bits.
HWY_INLINE IntVector below(IntVector count, BitVector random) {
  const auto place = hn::Mul(fraction(random), hn::ConvertTo(Floats(), count));
  return hn::Min(hn::ConvertTo(Ints(), place), hn::Sub(count, hn::Set(Ints(), 1)));
}

/// Of rays number `k` of lanes.
HWY_INLINE Ends ray_ends(const ShadowRayRequest& request, IntVector lane, BitVector k) {
  const Bits u32;
  const Ints i32;
  const SurfaceLayer& layer = request.surfaces.layer(request.layer);
  const auto scramble = [u32](BitVector bits) {
    return hn::Add(hn::Mul(bits, hn::Set(u32, 1664525u)), hn::Set(u32, 1013904223u));
  };
  const auto surface = hn::Add(lane, hn::Set(i32, static_cast<int>(request.layer * kGroupLanes)));
  auto x = scramble(hn::Set(u32, static_cast<std::uint32_t>(request.texel.texel + request.seed)));
  auto y = scramble(hn::BitCast(u32, surface));
  auto z = scramble(hn::Set(u32, static_cast<std::uint32_t>(request.seed >> 32)));
  mix(x, y, z);
  x = hn::Xor(x, hn::ShiftRight<16>(x));
  y = hn::Xor(y, hn::ShiftRight<16>(y));
  z = hn::Xor(z, hn::ShiftRight<16>(z));
  mix(x, y, z);
  // 1/ρ and 1/ρ² of the plastic number ρ, times 2³².
  const auto u = hn::Add(x, hn::Mul(k, hn::Set(u32, 3242174889u)));
  const auto v = hn::Add(y, hn::Mul(k, hn::Set(u32, 2447445414u)));
  const auto hit_count = pick(layer.hit_count, lane);
  auto hit = below(hit_count, z);
  const int last_k = request.first + request.count - 1;
  if (last_k > 0) {
    hit = hn::Add(hit, hn::Mul(hn::BitCast(i32, k), pick(layer.hit_step, lane)));
    for (int i = 0; i < last_k; ++i) {
      const auto less = hn::Sub(hit, hit_count);
      hit = hn::IfThenElse(hn::Lt(less, hn::Zero(i32)), hit, less);
    }
  }
  return {fraction(u), fraction(v), hn::Add(pick(layer.first_hit, lane), hit)};
}

HWY_INLINE FloatVector gather(const HitTable& hits, std::size_t component, IntVector hit) {
  return hn::GatherIndex(Floats(), hits.component(component), hit);
}
HWY_INLINE VectorOf3 gather3(const HitTable& hits, std::size_t first, IntVector hit) {
  return {gather(hits, first, hit), gather(hits, first + 1, hit), gather(hits, first + 2, hit)};
}

/// The middle of the quarter that is highest above the shading normal's horizon.
HWY_INLINE VectorOf3 best_quarter(const Quarters& quarters, const VectorOf3& shading_normal) {
  auto best = spread(quarters[0].direction);
  auto height = dot(shading_normal, best);
  for (std::size_t q = 1; q < kQuarters; ++q) {
    const auto middle = spread(quarters[q].direction);
    const auto other = dot(shading_normal, middle);
    best = select(hn::Gt(other, height), middle, best);
    height = hn::Max(other, height);
  }
  return best;
}

struct RayVector {
  VectorOf3 origin, direction;
};

HWY_INLINE RayVector ray_vector(const ShadowRayRequest& request, const Ends& ends,
                                hn::Mask<Floats> wanted) {
  const Floats f32;
  const TexelPatch& texel = request.texel;
  const HitTable& hits = request.surfaces.hits();
  auto direction = mul_add(spread(texel.across), ends.u, spread(texel.corner));
  direction = mul_add(spread(texel.up), ends.v, direction);
  auto origin = gather3(hits, HitTable::kOrigin, ends.hit);
  const auto geometric_normal = gather3(hits, HitTable::kGeometricNormal, ends.hit);
  const auto shading_normal = gather3(hits, HitTable::kShadingNormal, ends.hit);
  const auto above = hn::And(hn::Gt(dot(geometric_normal, direction), hn::Zero(f32)),
                             hn::Gt(dot(shading_normal, direction), hn::Zero(f32)));
  if (!hn::AllFalse(f32, hn::AndNot(above, wanted))) {
    direction = select(above, direction, best_quarter(*texel.quarters, shading_normal));
    // Behind the surface, rays start as far on its other side.
    const auto behind = hn::Lt(dot(geometric_normal, direction), hn::Zero(f32));
    const auto back = hn::Mul(gather(hits, HitTable::kOffset, ends.hit), hn::Set(f32, -2.0f));
    origin = mul_add(geometric_normal, hn::IfThenElseZero(behind, back), origin);
  }
  return {origin, direction};
}

/// The rays' slots: all of one lane, then all of the next.
HWY_INLINE void add_slots(const ShadowRayRequest& request, ShadowRays& rays) {
  std::uint32_t* slot = rays.slot.data() + rays.rays.count;
  for_each_lane(request.lanes, [&](std::size_t lane) {
    for (int i = 0; i < request.count; ++i) {
      *slot++ = request.first_slot + static_cast<std::uint32_t>(lane);
    }
  });
  rays.rays.count = static_cast<std::size_t>(slot - rays.slot.data());
}

void add_shadow_rays_impl(const ShadowRayRequest& request, ShadowRays& rays) {
  const Floats f32;
  const Ints i32;
  const Bits u32;
  SkyRays& to = rays.rays;
  const std::size_t begin = to.count;
  add_slots(request, rays);
  const auto k_mask = hn::Set(u32, static_cast<std::uint32_t>(request.count - 1));
  const auto first_k = hn::Set(u32, static_cast<std::uint32_t>(request.first));
  for (std::size_t at = begin; at < to.count; at += hn::Lanes(f32)) {
    const auto slot = hn::LoadU(u32, rays.slot.data() + at);
    const auto lane = hn::BitCast(i32, hn::And(slot, hn::Set(u32, kGroupLanes - 1)));
    const auto number = hn::Iota(u32, static_cast<std::uint32_t>(at - begin));
    const auto k = hn::Add(first_k, hn::And(number, k_mask));
    const RayVector ray =
        ray_vector(request, ray_ends(request, lane, k), hn::FirstN(f32, to.count - at));
    hn::StoreU(ray.origin.x, f32, to.origin[0].data() + at);
    hn::StoreU(ray.origin.y, f32, to.origin[1].data() + at);
    hn::StoreU(ray.origin.z, f32, to.origin[2].data() + at);
    hn::StoreU(ray.direction.x, f32, to.direction[0].data() + at);
    hn::StoreU(ray.direction.y, f32, to.direction[1].data() + at);
    hn::StoreU(ray.direction.z, f32, to.direction[2].data() + at);
  }
}

}  // namespace
}  // namespace rimlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight {

HWY_EXPORT(add_shadow_rays_impl);

void add_shadow_rays(const ShadowRayRequest& request, ShadowRays& rays) {
  RIMLIGHT_CHECK(request.first >= 0 && request.count > 0);
  RIMLIGHT_CHECK(std::has_single_bit(static_cast<unsigned>(request.count)));
  RIMLIGHT_CHECK_EQ(request.first_slot % kGroupLanes, 0u);
  RIMLIGHT_CHECK(rays.rays.count + static_cast<std::size_t>(request.count) * kGroupLanes <=
                 SkyRays::kCapacity);
  HWY_DYNAMIC_DISPATCH(add_shadow_rays_impl)(request, rays);
}

}  // namespace rimlight
#endif
