#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/bake/lambert_kernel.cpp"
#include "core/bake/lambert_kernel.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rimlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// 64 lanes are a whole number of vectors.
using Floats = hn::CappedTag<float, 16>;
using Ints = hn::RebindToSigned<Floats>;
using FloatVector = hn::Vec<Floats>;

/// Of the lanes from `i` on those in `lanes`.
HWY_INLINE hn::Mask<Floats> mask_of(LaneSet lanes, std::size_t i) {
  const Ints i32;
  const auto bit = hn::Shl(hn::Set(i32, 1), hn::Iota(i32, 0));
  return hn::RebindMask(Floats(),
                        hn::TestBit(hn::Set(i32, static_cast<int>((lanes >> i) & 0xffff)), bit));
}

HWY_INLINE FloatVector cosine(const LaneVectors& normal, const Vec3f& direction, std::size_t i) {
  const Floats f32;
  const auto x = hn::Mul(hn::Load(f32, normal[0].data() + i), hn::Set(f32, direction.x));
  const auto xy = hn::MulAdd(hn::Load(f32, normal[1].data() + i), hn::Set(f32, direction.y), x);
  return hn::MulAdd(hn::Load(f32, normal[2].data() + i), hn::Set(f32, direction.z), xy);
}

/// ∫ cos⁺θ dω for a vector of lanes.
HWY_INLINE FloatVector cosine_integral(const SurfaceLayer& layer, const Quarters& quarters,
                                       std::size_t i) {
  const Floats f32;
  const auto zero = hn::Zero(f32);
  auto sum = zero;
  for (std::size_t q = 0; q < kQuarters; ++q) {
    const QuadraturePoint& point = quarters[q];
    const auto facing = hn::Gt(cosine(layer.geometric_normal[q], point.direction, i), zero);
    const auto positive = hn::Max(cosine(layer.shading_normal[q], point.direction, i), zero);
    sum = hn::MulAdd(hn::IfThenElseZero(facing, positive), hn::Set(f32, point.solid_angle), sum);
  }
  return sum;
}

LaneSet facing_lanes_impl(const SurfaceLayer& layer, const Quarters& quarters) {
  const Floats f32;
  const std::size_t step = hn::Lanes(f32);
  LaneSet result = 0;
  for (std::size_t i = 0; i < kGroupLanes; i += step) {
    if (((layer.lanes >> i) & ((LaneSet{1} << step) - 1)) == 0) continue;
    const auto facing = hn::Gt(cosine_integral(layer, quarters, i), hn::Zero(f32));
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(f32, facing, bits);
    result |= (bits[0] | LaneSet{bits[1]} << 8) << i;
  }
  return result;
}

void add_lambert_impl(const SurfaceLayer& layer, const LitTexel& texel, float* HWY_RESTRICT row) {
  const Floats f32;
  const Ints i32;
  const hn::Rebind<std::uint8_t, Floats> u8;
  for (std::size_t i = 0; i < kGroupLanes; i += hn::Lanes(f32)) {
    const auto lit = hn::PromoteTo(i32, hn::Load(u8, texel.lit_rays + i));
    if (hn::AllTrue(i32, hn::Eq(lit, hn::Zero(i32)))) continue;
    const auto weight = hn::IfThenElse(mask_of(texel.refined, i),
                                       hn::Set(f32, texel.refined_weight), hn::Set(f32, 1.0f));
    const auto visibility = hn::Mul(hn::ConvertTo(f32, lit), weight);
    const auto seen = hn::Mul(cosine_integral(layer, texel.quarters, i), visibility);
    for (std::size_t c = 0; c < 3; ++c) {
      float* const place = row + c * kGroupLanes + i;
      const auto lambert = hn::Load(f32, layer.lambert[c].data() + i);
      hn::Store(hn::MulAdd(lambert, seen, hn::Load(f32, place)), f32, place);
    }
  }
}

}  // namespace
}  // namespace rimlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight {

HWY_EXPORT(facing_lanes_impl);
HWY_EXPORT(add_lambert_impl);

LaneSet facing_lanes(const SurfaceLayer& layer, const Quarters& quarters) {
  return HWY_DYNAMIC_DISPATCH(facing_lanes_impl)(layer, quarters);
}

void add_lambert(const SurfaceLayer& layer, const LitTexel& texel, float* row) {
  HWY_DYNAMIC_DISPATCH(add_lambert_impl)(layer, texel, row);
}

}  // namespace rimlight
#endif
