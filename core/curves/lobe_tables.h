#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/base/aligned_vector.h"
#include "core/curves/curve_material_state.h"
#include "core/material/brdf_curve.h"

namespace rimlight {

/// How the part of a lobe is found that no curve stands for.
///   none           there is no lobe
///   cook_torrance  G / (4 cos θ_i cos θ_o)
///   constant       1
///   measured       P(θ_i) P(θ_o)
///   scalar         by a call for each pair of directions
enum class LobeKind : std::uint8_t { none, cook_torrance, constant, measured, scalar };

/// A material's state as kernels read it. What a model's lobe is multiplied by for each channel
/// (`specular`) lies in a curve.
struct LobeTables {
  LobeKind kind = LobeKind::none;
  Brdf brdf;
  CurveAxis axis = CurveAxis::half_angle;  // of the bins that add_bins() adds to
  bool is_grey = false;                    // both curves are the same in all channels
  // The curves, [3][256]; 1 where a model has no such factor.
  AlignedVector<float> half_angle, difference_angle;
  AlignedVector<float> other;     // the curve over the other axis, [256][4]
  AlignedVector<float> log_rest;  // of P at its knots, [3][kRestKnots]
  float slope = 1;                // of LobeSums::sloped

  /// P(θ) of a measured BRDF.
  Vec3f rest(float cosine) const;
  /// The scalar kind's lobe.
  Vec3f lobe(const Vec3f& in, const Vec3f& out) const;
};

/// Tables for shading with all factors, or for T′ of one axis.
LobeTables make_tables(const CurveMaterialState& state, CurveAxis axis);
/// Tables for `fixed`: no lobe when an editable factor multiplies it.
LobeTables make_fixed_tables(const CurveMaterialState& state);

/// The diffuse part of radiance at a point with outgoing cosine `outgoing`, for albedo times
/// `tint`:
///     plain · a + sloped · b, of LobeSums.
struct DiffuseFactors {
  Vec3f plain, sloped;
};
DiffuseFactors diffuse_factors(const CurveMaterialState& state, const LobeTables& tables,
                               float outgoing);

}  // namespace rimlight
