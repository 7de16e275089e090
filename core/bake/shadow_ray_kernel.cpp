#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/bake/shadow_ray_kernel.cpp"
#include "core/bake/shadow_ray_kernel.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

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

/// Where a surface's rays to a texel stand: at a point of the texel and at one of the hits.
class Walk {
 public:
  HWY_INLINE Walk(const SurfaceLayer& layer, std::size_t texel, std::size_t i)
      : hit_count_(hn::Load(Ints(), layer.hit_count.data() + i)),
        hit_step_(hn::Load(Ints(), layer.hit_step.data() + i)) {
    const Bits u32;
    const auto scramble = [u32](BitVector v) {
      return hn::Add(hn::Mul(v, hn::Set(u32, 1664525u)), hn::Set(u32, 1013904223u));
    };
    auto x = scramble(hn::Set(u32, static_cast<std::uint32_t>(texel)));
    auto y = scramble(hn::Load(u32, layer.seed_low.data() + i));
    auto z = scramble(hn::Load(u32, layer.seed_high.data() + i));
    mix(x, y, z);
    x = hn::Xor(x, hn::ShiftRight<16>(x));
    y = hn::Xor(y, hn::ShiftRight<16>(y));
    z = hn::Xor(z, hn::ShiftRight<16>(z));
    mix(x, y, z);
    u_ = x;
    v_ = y;
    const auto place = hn::Mul(fraction(z), hn::ConvertTo(Floats(), hit_count_));
    hit_ = hn::Min(hn::ConvertTo(Ints(), place), hn::Sub(hit_count_, hn::Set(Ints(), 1)));
  }

  HWY_INLINE void advance() {
    // 1/ρ and 1/ρ² of the plastic number ρ, times 2³².
    u_ = hn::Add(u_, hn::Set(Bits(), 3242174889u));
    v_ = hn::Add(v_, hn::Set(Bits(), 2447445414u));
    const auto next = hn::Add(hit_, hit_step_);
    hit_ = hn::IfThenElse(hn::Lt(next, hit_count_), next, hn::Sub(next, hit_count_));
  }

  HWY_INLINE FloatVector u() const { return fraction(u_); }
  HWY_INLINE FloatVector v() const { return fraction(v_); }
  HWY_INLINE IntVector hit() const { return hit_; }

 private:
  static HWY_INLINE void mix(BitVector& x, BitVector& y, BitVector& z) {
    x = hn::Add(x, hn::Mul(y, z));
    y = hn::Add(y, hn::Mul(z, x));
    z = hn::Add(z, hn::Mul(x, y));
  }

  BitVector u_, v_;
  IntVector hit_, hit_count_, hit_step_;
};

/// A hit for each lane.
struct Hits {
  VectorOf3 position, geometric_normal, shading_normal;
  FloatVector offset;

  HWY_INLINE Hits(const HitTable& table, IntVector index)
      : position{gather(table, 0, index), gather(table, 1, index), gather(table, 2, index)},
        geometric_normal{gather(table, 4, index), gather(table, 5, index), gather(table, 6, index)},
        shading_normal{gather(table, 7, index), gather(table, 8, index), gather(table, 9, index)},
        offset(gather(table, 3, index)) {}

  static HWY_INLINE FloatVector gather(const HitTable& table, std::size_t component,
                                       IntVector index) {
    return hn::GatherIndex(Floats(), table.component(component), index);
  }
};

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

HWY_INLINE RayVector ray_vector(const Hits& hits, const TexelPatch& texel, const Walk& walk,
                                hn::Mask<Floats> wanted) {
  const auto zero = hn::Zero(Floats());
  auto direction = mul_add(spread(texel.across), walk.u(), spread(texel.corner));
  direction = mul_add(spread(texel.up), walk.v(), direction);
  const auto above = hn::And(hn::Gt(dot(hits.geometric_normal, direction), zero),
                             hn::Gt(dot(hits.shading_normal, direction), zero));
  auto offset = hits.offset;
  if (!hn::AllFalse(Floats(), hn::AndNot(above, wanted))) {
    direction = select(above, direction, best_quarter(*texel.quarters, hits.shading_normal));
    const auto behind = hn::Lt(dot(hits.geometric_normal, direction), zero);
    offset = hn::IfThenElse(behind, hn::Neg(offset), offset);
  }
  return {mul_add(hits.geometric_normal, offset, hits.position), direction};
}

void add_shadow_rays_impl(const ShadowRayRequest& request, ShadowRays& rays) {
  const Floats f32;
  const Ints i32;
  const Bits u32;
  SkyRays& to = rays.rays;
  const std::size_t step = hn::Lanes(f32);
  const auto lane_bits = hn::Shl(hn::Set(i32, 1), hn::Iota(i32, 0));
  for (std::size_t i = 0; i < kGroupLanes; i += step) {
    const auto bits = static_cast<int>((request.lanes >> i) & ((LaneSet{1} << step) - 1));
    if (bits == 0) continue;
    const auto wanted = hn::TestBit(hn::Set(i32, bits), lane_bits);
    const auto wanted_floats = hn::RebindMask(f32, wanted);
    const auto slot = hn::Iota(u32, request.first_slot + static_cast<std::uint32_t>(i));
    const auto first_hit = hn::Load(i32, request.layer.first_hit.data() + i);
    Walk walk(request.layer, request.texel.texel, i);
    for (int k = 0; k < request.end; ++k, walk.advance()) {
      if (k < request.first) continue;
      const Hits hits(request.hits, hn::Add(first_hit, walk.hit()));
      const RayVector ray = ray_vector(hits, request.texel, walk, wanted_floats);
      const std::size_t at = to.count;
      hn::CompressStore(ray.origin.x, wanted_floats, f32, to.origin[0].data() + at);
      hn::CompressStore(ray.origin.y, wanted_floats, f32, to.origin[1].data() + at);
      hn::CompressStore(ray.origin.z, wanted_floats, f32, to.origin[2].data() + at);
      hn::CompressStore(ray.direction.x, wanted_floats, f32, to.direction[0].data() + at);
      hn::CompressStore(ray.direction.y, wanted_floats, f32, to.direction[1].data() + at);
      hn::CompressStore(ray.direction.z, wanted_floats, f32, to.direction[2].data() + at);
      to.count += hn::CompressStore(slot, hn::RebindMask(u32, wanted), u32, rays.slot.data() + at);
    }
  }
}

}  // namespace
}  // namespace rimlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight {

HWY_EXPORT(add_shadow_rays_impl);

void add_shadow_rays(const ShadowRayRequest& request, ShadowRays& rays) {
  RIMLIGHT_CHECK(rays.rays.count +
                     static_cast<std::size_t>(request.end - request.first) * kGroupLanes <=
                 SkyRays::kCapacity);
  HWY_DYNAMIC_DISPATCH(add_shadow_rays_impl)(request, rays);
}

}  // namespace rimlight
#endif
