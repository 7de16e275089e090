#include "core/curves/lobe_tables.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/check.h"

namespace rimlight {
namespace {

/// Planar, times `scale`; ones where there is no curve.
AlignedVector<float> planar(const std::optional<BrdfCurve>& curve, const Vec3f& scale) {
  AlignedVector<float> values(3 * kCurveBins);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const int c = static_cast<int>(i / kCurveBins);
    values[i] = scale[c] * (curve ? curve->values[i % kCurveBins][c] : 1);
  }
  return values;
}

bool is_grey(const AlignedVector<float>& curve) {
  const auto* const first = curve.data();
  return std::equal(first, first + kCurveBins, first + kCurveBins) &&
         std::equal(first, first + kCurveBins, first + 2 * kCurveBins);
}

LobeKind kind_of(const CurveMaterialState& state) {
  if (state.measured) return LobeKind::measured;
  switch (state.brdf.model) {
    case BrdfModel::lambert:
      return LobeKind::none;
    case BrdfModel::cook_torrance:
      return LobeKind::cook_torrance;
    case BrdfModel::blinn_phong:
      return LobeKind::constant;
    default:
      return LobeKind::scalar;
  }
}

/// The lobe's factor that is left out of quotient() by kinds that are not scalar.
Vec3f scale_of(const CurveMaterialState& state, LobeKind kind) {
  const bool is_scaled = kind == LobeKind::cook_torrance || kind == LobeKind::constant;
  return is_scaled ? state.brdf.specular : Vec3f{1, 1, 1};
}

}  // namespace

LobeTables make_tables(const CurveMaterialState& state, CurveAxis axis) {
  LobeTables tables;
  tables.kind = kind_of(state);
  tables.brdf = state.brdf;
  tables.axis = axis;
  const Vec3f scale = scale_of(state, tables.kind);
  tables.half_angle = planar(state.half_angle, scale);
  tables.difference_angle = planar(state.difference_angle, {1, 1, 1});
  tables.is_grey = is_grey(tables.half_angle) && is_grey(tables.difference_angle);
  const CurveAxis across =
      axis == CurveAxis::half_angle ? CurveAxis::difference_angle : CurveAxis::half_angle;
  const AlignedVector<float> other = planar(state.curve(across), scale);
  tables.other.resize(4 * kCurveBins);
  for (std::size_t i = 0; i < other.size(); ++i) {
    tables.other[i % kCurveBins * 4 + i / kCurveBins] = other[i];
  }
  if (state.measured) {
    for (int c = 0; c < 3; ++c) {
      for (const Vec3f& knot : state.measured->rest) {
        tables.log_rest.push_back(std::log(std::max(knot[c], 1e-37f)));
      }
    }
  }
  tables.slope = state.brdf.model == BrdfModel::ashikhmin_shirley ? 0.5f : 1.0f;
  return tables;
}

LobeTables make_fixed_tables(const CurveMaterialState& state) {
  LobeTables tables = make_tables(state, CurveAxis::half_angle);
  if (state.half_angle || state.difference_angle) tables.kind = LobeKind::none;
  return tables;
}

Vec3f LobeTables::lobe(const Vec3f& in, const Vec3f& out) const {
  if (brdf.model != BrdfModel::ashikhmin_shirley) return evaluate_specular(brdf, in, out);
  return Vec3f(quotient(brdf, {.difference_angle = true}, Vec3d(in), Vec3d(out)));
}

Vec3f LobeTables::rest(float cosine) const {
  const float position = std::acos(std::min(cosine, 1.0f)) * static_cast<float>(kRestKnots - 1) *
                         (2 * std::numbers::inv_pi_v<float>);
  const std::size_t lower = std::min(kRestKnots - 2, static_cast<std::size_t>(position));
  const float share = position - static_cast<float>(lower);
  Vec3f result;
  for (int c = 0; c < 3; ++c) {
    const float* const knots = log_rest.data() + static_cast<std::size_t>(c) * kRestKnots + lower;
    result[c] = std::exp(knots[0] + share * (knots[1] - knots[0]));
  }
  return result;
}

DiffuseFactors diffuse_factors(const CurveMaterialState& state, const LobeTables& tables,
                               float outgoing) {
  if (state.measured || !(outgoing > 0) || !(max_component(state.brdf.albedo) > 0)) return {};
  // Every model's diffuse term is affine in 1 − (1 − slope · cos θ_i)^5: two values tell it.
  constexpr float kLow = 0.25f;
  const Vec3f out{std::sqrt(std::max(0.0f, 1 - outgoing * outgoing)), 0, outgoing};
  const auto rest = [&](float cosine) {
    const float x = 1 - tables.slope * cosine, x2 = x * x;
    return 1 - x2 * x2 * x;
  };
  const Vec3f high = evaluate_diffuse(state.brdf, {0, 0, 1}, out);
  const Vec3f low = evaluate_diffuse(state.brdf, {0.968245837f, 0, kLow}, out);
  const Vec3f sloped = (high - low) / (rest(1) - rest(kLow));
  return {high - sloped * rest(1), sloped};
}

}  // namespace rimlight
