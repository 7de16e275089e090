// What a surface point and vectors of points of light have in common, for surface_kernel.cpp.
// Included once for each SIMD target.
#if defined(RIMLIGHT_CORE_CURVES_SURFACE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RIMLIGHT_CORE_CURVES_SURFACE_LANES_INL_H_
#undef RIMLIGHT_CORE_CURVES_SURFACE_LANES_INL_H_
#else
#define RIMLIGHT_CORE_CURVES_SURFACE_LANES_INL_H_
#endif

#include <hwy/highway.h>
// After highway.h.
#include <hwy/contrib/math/math-inl.h>

#include "core/curves/surface_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace rimlight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, LightPoints::kVector>;
using Integers = hn::RebindToSigned<Floats>;
using Vector = hn::Vec<Floats>;
using Mask = hn::Mask<Floats>;

struct Vector3 {
  Vector x, y, z;
};

HWY_INLINE Vector set(float value) { return hn::Set(Floats(), value); }

/// 1 / √x, one step of Newton's after the processor's own: 22 bits.
HWY_INLINE Vector reciprocal_root(Vector x) {
  const Vector y = hn::ApproximateReciprocalSqrt(x);
  const Vector half = hn::Mul(hn::Mul(set(0.5f), x), y);
  return hn::Mul(y, hn::NegMulAdd(half, y, set(1.5f)));
}

HWY_INLINE Vector reciprocal(Vector x) {
  const Vector y = hn::ApproximateReciprocal(x);
  return hn::Mul(y, hn::NegMulAdd(x, y, set(2)));
}

HWY_INLINE Vector dot(const Vector3& a, const Vec3f& b) {
  return hn::MulAdd(a.x, set(b.x), hn::MulAdd(a.y, set(b.y), hn::Mul(a.z, set(b.z))));
}

/// The angle in [0, π/2] whose tangent is √(y2 / x2), both ≥ 0. By Abramowitz and Stegun's 4.4.49
/// for the arc tangent on [0, 1], to 2e-8 of it.
HWY_INLINE Vector angle_of_squares(Vector y2, Vector x2) {
  const Vector low = hn::Min(y2, x2), high = hn::Max(y2, x2);
  const Vector r = hn::Mul(low, reciprocal_root(hn::Max(hn::Mul(low, high), set(1e-36f))));
  const Vector q = hn::Mul(r, r);
  Vector sum = set(0.0028662257f);
  sum = hn::MulAdd(sum, q, set(-0.0161657367f));
  sum = hn::MulAdd(sum, q, set(0.0429096138f));
  sum = hn::MulAdd(sum, q, set(-0.0752896400f));
  sum = hn::MulAdd(sum, q, set(0.1065626393f));
  sum = hn::MulAdd(sum, q, set(-0.1420889944f));
  sum = hn::MulAdd(sum, q, set(0.1999355085f));
  sum = hn::MulAdd(sum, q, set(-0.3333314528f));
  const Vector angle = hn::MulAdd(hn::Mul(sum, q), r, r);
  return hn::IfThenElse(hn::Gt(y2, x2), hn::Sub(set(1.57079637f), angle), angle);
}

/// Whole numbers of [0, 255].
HWY_INLINE hn::Vec<Integers> bin(Vector position) {
  const Integers d;
  const auto whole = hn::ConvertTo(d, position);
  return hn::Min(hn::Max(whole, hn::Zero(d)), hn::Set(d, static_cast<int>(kCurveBins) - 1));
}

constexpr float kBinsPerRadian = 162.974662f;  // 256 / (π/2)

/// Points above both horizons.
struct Lit {
  Mask mask;
  Vector3 in;     // local; z alone before find_direction()
  Vector weight;  // V Δω cos θ_i, 0 outside the mask
  Vector3 world;
};

struct Bins {
  hn::Vec<Integers> half, difference;
};

/// Everything about one point of a surface that stays the same for all points of light.
class Surface {
 public:
  Surface(const LobeTables& tables, const LobePoint& point, const LitQuarter& light)
      : tables_(tables), point_(point), light_(light) {}

  HWY_INLINE Lit find_lit(std::size_t first) const {
    const Floats d;
    const auto& points = *light_.points;
    const Vector3 world{hn::Load(d, points.x.data() + first), hn::Load(d, points.y.data() + first),
                        hn::Load(d, points.z.data() + first)};
    const Vector cosine = dot(world, point_.normal);
    const Vector seen = hn::Mul(hn::Load(d, light_.visibility + first),
                                hn::Load(d, light_.radiance->is_lit.data() + first));
    const Vector weight =
        hn::Mul(hn::Mul(seen, hn::Load(d, points.solid_angle.data() + first)), cosine);
    const Mask above = hn::And(hn::Gt(dot(world, point_.geometric_normal), hn::Zero(d)),
                               hn::Gt(weight, hn::Zero(d)));
    return {above, {cosine, cosine, cosine}, hn::IfThenElseZero(above, weight), world};
  }

  HWY_INLINE void find_direction(Lit& lit) const {
    lit.in.x = dot(lit.world, point_.tangent);
    lit.in.y = dot(lit.world, point_.bitangent);
  }

  HWY_INLINE Vector3 radiance(std::size_t first) const {
    const Floats d;
    const auto& rgb = light_.radiance->radiance;
    return {hn::Load(d, rgb[0].data() + first), hn::Load(d, rgb[1].data() + first),
            hn::Load(d, rgb[2].data() + first)};
  }

  /// The lobe without any curve, times the lit points' weight; and the bins of its angles.
  template <LobeKind kKind>
  HWY_INLINE Vector3 find_lobe(const Lit& lit, Bins& bins) const {
    const Vector3& in = lit.in;
    const Vec3f& out = point_.outgoing;
    const Vector x = hn::Add(in.x, set(out.x)), y = hn::Add(in.y, set(out.y)),
                 z = hn::Add(in.z, set(out.z));
    const Vector flat = hn::MulAdd(x, x, hn::Mul(y, y)), upright = hn::Mul(z, z);
    const Vector sum = hn::Add(flat, upright);
    const Vector dx = hn::Sub(in.x, set(out.x)), dy = hn::Sub(in.y, set(out.y)),
                 dz = hn::Sub(in.z, set(out.z));
    const Vector apart = hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz)));
    const Vector half = hn::Mul(angle_of_squares(flat, upright),
                                set(kBinsPerRadian * static_cast<float>(kCurveBins)));
    // √ of 256² · the share of π/2.
    bins.half = bin(hn::Mul(half, reciprocal_root(hn::Max(half, set(1e-36f)))));
    bins.difference = bin(hn::Mul(angle_of_squares(apart, sum), set(kBinsPerRadian)));
    if constexpr (kKind == LobeKind::cook_torrance) return cavity(lit, z, sum);
    if constexpr (kKind == LobeKind::measured) return measured(lit);
    if constexpr (kKind == LobeKind::scalar) return scalar(lit);
    return {lit.weight, lit.weight, lit.weight};
  }

 private:
  /// G / (4 cos θ_i cos θ_o) of V-cavities: min(1 / low, 4 z / |sum|²) / (4 high), z the sum's.
  HWY_INLINE Vector3 cavity(const Lit& lit, Vector z, Vector sum) const {
    const Vector out = set(point_.outgoing.z);
    const Vector low = hn::Min(lit.in.z, out), high = hn::Max(lit.in.z, out);
    const Mask is_open = hn::Le(sum, hn::Mul(hn::Mul(set(4), z), low));
    const Vector above = hn::IfThenElse(is_open, set(1), z);
    const Vector below = hn::Mul(high, hn::IfThenElse(is_open, hn::Mul(set(4), low), sum));
    const Vector value = hn::Mul(lit.weight, hn::Mul(above, reciprocal(below)));
    const Vector kept = hn::IfThenElseZero(lit.mask, value);
    return {kept, kept, kept};
  }

  HWY_INLINE Vector3 measured(const Lit& lit) const {
    const Floats d;
    const Integers whole;
    const Vector flat = hn::MulAdd(lit.in.x, lit.in.x, hn::Mul(lit.in.y, lit.in.y));
    constexpr auto kSpans = static_cast<int>(kRestKnots) - 1;
    const Vector position = hn::Mul(angle_of_squares(flat, hn::Mul(lit.in.z, lit.in.z)),
                                    set(0.636619747f * static_cast<float>(kSpans)));
    const auto lower = hn::Min(hn::Max(hn::ConvertTo(whole, position), hn::Zero(whole)),
                               hn::Set(whole, kSpans - 1));
    const Vector share = hn::Sub(position, hn::ConvertTo(d, lower));
    const auto rest = [&](std::size_t channel) HWY_ATTR {
      const float* const knots = tables_.log_rest.data() + channel * kRestKnots;
      const Vector from = hn::GatherIndex(d, knots, lower);
      const Vector to = hn::GatherIndex(d, knots + 1, lower);
      const Vector value = hn::Exp(d, hn::MulAdd(share, hn::Sub(to, from), from));
      const float out = point_.rest_out[static_cast<int>(channel)];
      return hn::IfThenElseZero(lit.mask, hn::Mul(lit.weight, hn::Mul(set(out), value)));
    };
    return {rest(0), rest(1), rest(2)};
  }

  Vector3 scalar(const Lit& lit) const {
    const Floats d;
    HWY_ALIGN float x[LightPoints::kVector], y[LightPoints::kVector], z[LightPoints::kVector];
    hn::Store(lit.in.x, d, x);
    hn::Store(lit.in.y, d, y);
    hn::Store(lit.in.z, d, z);
    HWY_ALIGN float is_lit[LightPoints::kVector];
    hn::Store(hn::IfThenElseZero(lit.mask, set(1)), d, is_lit);
    for (std::size_t i = 0; i < hn::Lanes(d); ++i) {
      Vec3f value;
      if (is_lit[i] != 0) value = tables_.lobe({x[i], y[i], z[i]}, point_.outgoing);
      x[i] = value.x;
      y[i] = value.y;
      z[i] = value.z;
    }
    return {hn::Mul(lit.weight, hn::Load(d, x)), hn::Mul(lit.weight, hn::Load(d, y)),
            hn::Mul(lit.weight, hn::Load(d, z))};
  }

  const LobeTables& tables_;
  const LobePoint& point_;
  const LitQuarter& light_;
};

}  // namespace rimlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target
