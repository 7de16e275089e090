// Compiled once for each SIMD target; the one in use is chosen at the first call.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/curves/surface_kernel.cpp"
#include "core/curves/surface_kernel.h"

#include <hwy/foreach_target.h>  // IWYU pragma: keep; before highway.h
#include <hwy/highway.h>
// After highway.h.
#include <hwy/contrib/math/math-inl.h>

HWY_BEFORE_NAMESPACE();
namespace rimlight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, LightPoints::kVector>;
using Integers = hn::RebindToSigned<Floats>;
using Vector = hn::Vec<Floats>;
using Mask = hn::Mask<Floats>;
using Four = hn::CappedTag<float, 4>;

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

/// Sums of RGB that stay in registers.
struct Sum3 {
  Vector x, y, z;

  HWY_INLINE void add(Vector weight, const Vector3& rgb) {
    x = hn::MulAdd(weight, rgb.x, x);
    y = hn::MulAdd(weight, rgb.y, y);
    z = hn::MulAdd(weight, rgb.z, z);
  }
  HWY_INLINE Vec3f total() const {
    const Floats d;
    return {hn::GetLane(hn::SumOfLanes(d, x)), hn::GetLane(hn::SumOfLanes(d, y)),
            hn::GetLane(hn::SumOfLanes(d, z))};
  }
};

HWY_INLINE Sum3 no_sum() {
  const Vector zero = hn::Zero(Floats());
  return {zero, zero, zero};
}

/// 1 − (1 − slope cos θ)^5
HWY_INLINE Vector rest_of_fifth_power(Vector cosine, float slope) {
  const Vector x = hn::NegMulAdd(cosine, set(slope), set(1));
  const Vector x2 = hn::Mul(x, x);
  return hn::NegMulAdd(hn::Mul(x2, x2), x, set(1));
}

HWY_INLINE Vector look_up(const AlignedVector<float>& curve, std::size_t channel,
                          hn::Vec<Integers> at) {
  return hn::GatherIndex(Floats(), curve.data() + channel * kCurveBins, at);
}

/// The lobe with both curves.
HWY_INLINE void add_curved(const LobeTables& tables, const Bins& bins, const Vector3& lobe,
                           const Vector3& radiance, Sum3& sum) {
  if (tables.is_grey) {
    const Vector curves = hn::Mul(look_up(tables.half_angle, 0, bins.half),
                                  look_up(tables.difference_angle, 0, bins.difference));
    sum.add(curves, {hn::Mul(lobe.x, radiance.x), hn::Mul(lobe.y, radiance.y),
                     hn::Mul(lobe.z, radiance.z)});
    return;
  }
  const auto curves = [&](std::size_t channel) HWY_ATTR {
    return hn::Mul(look_up(tables.half_angle, channel, bins.half),
                   look_up(tables.difference_angle, channel, bins.difference));
  };
  sum.x = hn::MulAdd(hn::Mul(curves(0), lobe.x), radiance.x, sum.x);
  sum.y = hn::MulAdd(hn::Mul(curves(1), lobe.y), radiance.y, sum.y);
  sum.z = hn::MulAdd(hn::Mul(curves(2), lobe.z), radiance.z, sum.z);
}

template <LobeKind kKind>
void add_shading_of(const LobeTables& tables, const LobePoint& point, const LitQuarter& light,
                    LobeSums& sums) {
  const Floats d;
  const Surface surface(tables, point, light);
  Sum3 plain = no_sum(), sloped = no_sum(), lobes = no_sum();
  for (const std::uint32_t vector : light.vectors) {
    for (std::size_t lane = 0; lane < LightPoints::kVector; lane += hn::Lanes(d)) {
      const std::size_t first = vector * LightPoints::kVector + lane;
      Lit lit = surface.find_lit(first);
      if (hn::AllFalse(d, lit.mask)) continue;
      const Vector3 radiance = surface.radiance(first);
      plain.add(lit.weight, radiance);
      sloped.add(hn::Mul(lit.weight, rest_of_fifth_power(lit.in.z, tables.slope)), radiance);
      if constexpr (kKind == LobeKind::none) continue;
      surface.find_direction(lit);
      Bins bins;
      const Vector3 lobe = surface.find_lobe<kKind>(lit, bins);
      add_curved(tables, bins, lobe, radiance, lobes);
    }
  }
  sums.plain += plain.total();
  sums.sloped += sloped.total();
  sums.lobe += lobes.total();
}

/// Numbers of one vector, to be added to bins one by one: Highway has no scatter that adds.
struct Scattered {
  HWY_ALIGN float rgb[4 * LightPoints::kVector];
  HWY_ALIGN std::int32_t at[LightPoints::kVector], other[LightPoints::kVector];
};

HWY_INLINE void scatter(Mask mask, const Scattered& from, const float* HWY_RESTRICT other,
                        float* HWY_RESTRICT bins) {
  const Floats d;
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  for (std::uint32_t bits = bytes[0] | static_cast<std::uint32_t>(bytes[1]) << 8; bits != 0;
       bits &= bits - 1) {
    const auto i = static_cast<std::size_t>(__builtin_ctz(bits));
    // Neighbours often share a bin: every other one goes to a copy, so as not to wait for it.
    float* const to = bins + i % 2 * (4 * kCurveBins) + 4 * static_cast<std::size_t>(from.at[i]);
    const float* const factor = other + 4 * static_cast<std::size_t>(from.other[i]);
    const Four four;
    for (std::size_t c = 0; c < 4; c += hn::Lanes(four)) {
      const auto sum = hn::MulAdd(hn::Load(four, from.rgb + 4 * i + c), hn::Load(four, factor + c),
                                  hn::Load(four, to + c));
      hn::Store(sum, four, to + c);
    }
  }
}

template <LobeKind kKind>
void add_bins_of(const LobeTables& tables, const LobePoint& point, const LitQuarter& light,
                 LobeSums& sums, float* HWY_RESTRICT bins) {
  const Floats d;
  const Integers whole;
  const Surface surface(tables, point, light);
  const bool is_half = tables.axis == CurveAxis::half_angle;
  Sum3 plain = no_sum(), sloped = no_sum();
  Scattered values;
  for (const std::uint32_t vector : light.vectors) {
    for (std::size_t lane = 0; lane < LightPoints::kVector; lane += hn::Lanes(d)) {
      const std::size_t first = vector * LightPoints::kVector + lane;
      Lit lit = surface.find_lit(first);
      if (hn::AllFalse(d, lit.mask)) continue;
      const Vector3 radiance = surface.radiance(first);
      plain.add(lit.weight, radiance);
      sloped.add(hn::Mul(lit.weight, rest_of_fifth_power(lit.in.z, tables.slope)), radiance);
      surface.find_direction(lit);
      Bins at;
      const Vector3 lobe = surface.find_lobe<kKind>(lit, at);
      hn::StoreInterleaved4(hn::Mul(lobe.x, radiance.x), hn::Mul(lobe.y, radiance.y),
                            hn::Mul(lobe.z, radiance.z), hn::Zero(d), d, values.rgb);
      hn::Store(is_half ? at.half : at.difference, whole, values.at);
      hn::Store(is_half ? at.difference : at.half, whole, values.other);
      scatter(lit.mask, values, tables.other.data(), bins);
    }
  }
  sums.plain += plain.total();
  sums.sloped += sloped.total();
}

void add_shading_lanes(const LobeTables& tables, const LobePoint& point, const LitQuarter& light,
                       LobeSums& sums) {
  switch (tables.kind) {
    case LobeKind::none:
      return add_shading_of<LobeKind::none>(tables, point, light, sums);
    case LobeKind::cook_torrance:
      return add_shading_of<LobeKind::cook_torrance>(tables, point, light, sums);
    case LobeKind::constant:
      return add_shading_of<LobeKind::constant>(tables, point, light, sums);
    case LobeKind::measured:
      return add_shading_of<LobeKind::measured>(tables, point, light, sums);
    case LobeKind::scalar:
      return add_shading_of<LobeKind::scalar>(tables, point, light, sums);
  }
}

void add_bins_lanes(const LobeTables& tables, const LobePoint& point, const LitQuarter& light,
                    LobeSums& sums, float* bins) {
  switch (tables.kind) {
    case LobeKind::none:
      return add_shading_of<LobeKind::none>(tables, point, light, sums);
    case LobeKind::cook_torrance:
      return add_bins_of<LobeKind::cook_torrance>(tables, point, light, sums, bins);
    case LobeKind::constant:
      return add_bins_of<LobeKind::constant>(tables, point, light, sums, bins);
    case LobeKind::measured:
      return add_bins_of<LobeKind::measured>(tables, point, light, sums, bins);
    case LobeKind::scalar:
      return add_bins_of<LobeKind::scalar>(tables, point, light, sums, bins);
  }
}

}  // namespace rimlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight {

HWY_EXPORT(add_shading_lanes);
HWY_EXPORT(add_bins_lanes);

void add_shading(const LobeTables& tables, const LobePoint& point, const LitQuarter& light,
                 LobeSums& sums) noexcept {
  HWY_DYNAMIC_DISPATCH(add_shading_lanes)(tables, point, light, sums);
}

void add_bins(const LobeTables& tables, const LobePoint& point, const LitQuarter& light,
              LobeSums& sums, std::span<float, kBinFloats> bins) noexcept {
  HWY_DYNAMIC_DISPATCH(add_bins_lanes)(tables, point, light, sums, bins.data());
}

}  // namespace rimlight
#endif  // HWY_ONCE
