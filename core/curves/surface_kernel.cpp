// Compiled once for each SIMD target; the one in use is chosen at the first call.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/curves/surface_kernel.cpp"
#include "core/curves/surface_kernel.h"

#include <hwy/foreach_target.h>  // IWYU pragma: keep; before highway.h
#include <hwy/highway.h>
// After highway.h.
#include "core/curves/surface_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rimlight::HWY_NAMESPACE {

using Four = hn::CappedTag<float, 4>;

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
