#pragma once

#include <span>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/basis/sh_directions.h"
#include "core/math/rotation.h"

namespace rimlight::sh {

// Functions on the sphere to coefficients and back. Values at directions are planar, [signal]
// [directions.count()], and so are coefficients, [signal][(degree + 1)²]. Sizes that do not fit
// each other, and degrees out of range, are CheckFailures.

/// Directions with weights, for integrals over the sphere: ∫ f dω ≈ Σ weight · f(direction).
struct SphereQuadrature {
  Directions directions;
  AlignedVector<float> weights;  // [padded(count)], zero in the padding
};

/// The texels of a cube map (conventions: cube_map.h) by their middles and exact solid angles, in
/// the order of their index, each direction turned by `rotation`. With degree l and size N the
/// basis varies by l(l + 1)/(2N²) of itself inside a texel, which is the relative error of
/// projecting.
SphereQuadrature cube_quadrature(int size, const Quaternion& rotation = {});

/// f_lm = Σ weight · f · Y_lm. Values must be finite. In float within blocks of 64 directions and
/// in double from block to block: the same bits for one SIMD target.
std::vector<float> project(const SphereQuadrature& quadrature, std::span<const float> values,
                           int degree);

/// The values of Σ f_lm Y_lm at directions. The sum is in float.
std::vector<float> reconstruct(std::span<const float> coefficients, int degree,
                               const Directions& directions);

/// The values of each band of one signal by itself, Σ_m f_lm Y_lm: [degree +
/// 1][directions.count()].
std::vector<float> reconstruct_bands(std::span<const float> coefficients,
                                     const Directions& directions);

/// Coefficients fitted to values at any directions.
struct Fit {
  std::vector<float> coefficients;  // [signal][(degree + 1)²]
  /// Largest over smallest singular value of [Y_lm(direction)]: by so much noise of the values can
  /// grow in the coefficients. Near 1 for even directions, many more than coefficients.
  double condition = 0;
};

/// A fit's directions × coefficients may be at most so many (1 GiB of doubles).
inline constexpr std::size_t kLargestFit = std::size_t{1} << 27;

/// The coefficients that minimise Σ (Σ_lm f_lm Y_lm − f)² over the directions (of any length but
/// zero), each counting the same: by Householder QR in double, at 2 · directions · coefficients²
/// operations. To kLargestDegree. Error (where "fit of spherical harmonics") when a value or a
/// direction is not finite or a direction is zero, when there are too many, or when the directions
/// do not tell all coefficients apart: their rank is below (degree + 1)².
Fit fit(std::span<const Vec3d> directions, std::span<const float> values, int degree);

}  // namespace rimlight::sh
