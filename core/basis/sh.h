#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/math/vec.h"

namespace rimlight {

/// Real orthonormal spherical harmonics. The convention, stated once:
///
///   degree l = 0 … 32 (for a light 64), one *band* a degree; m = −l … l
///   index    l² + l + m; all bands to degree n are (n + 1)² coefficients
///   Y_lm     = Q_l^|m|(z) · Re (x + iy)^m      for m ≥ 0
///            = Q_l^|m|(z) · Im (x + iy)^|m|    for m < 0,   at the unit direction (x, y, z)
///   Q_l^m    > 0 at z = 1, a polynomial of degree l − m, scaled so that ∫ Y_lm² dω = 1
///
/// The polar axis is z, and there is no Condon–Shortley phase: Y_1,−1 … Y_1,1 = √(3/4π) · (y, z,
/// x). A function f has the coefficients f_lm = ∫ f Y_lm dω. Several signals (the channels of a
/// light) are planar: [signal][(n + 1)²].
namespace sh {

/// Of transport, and of what is shown.
inline constexpr int kLargestDegree = 32;
/// Of a light: its product with transport of degree n, back to degree n, sees a light to degree 2n.
/// Everything here goes so far.
inline constexpr int kLargestLightDegree = 2 * kLargestDegree;

/// How many coefficients the bands 0 … degree have.
constexpr std::size_t coefficient_count(int degree) {
  return static_cast<std::size_t>(degree + 1) * static_cast<std::size_t>(degree + 1);
}

constexpr std::size_t index(int degree, int m) {
  return static_cast<std::size_t>(degree * degree + degree + m);
}

/// The band that a coefficient is in.
constexpr int degree_of(std::size_t coefficient) {
  int degree = 0;
  while (coefficient_count(degree) <= coefficient) ++degree;
  return degree;
}

/// All Y_lm to a degree at one direction (any length but zero), in double: within 4e-13 of the
/// truth to degree 32, 2.5e-12 to 64. For many directions see sh_kernel.h. CheckFailure for a
/// degree out of range, or when `values` is not [(degree + 1)²].
void evaluate(const Vec3d& direction, int degree, std::span<double> values);
std::vector<double> evaluate(const Vec3d& direction, int degree);

/// The Legendre polynomials P_0 … P_degree at a cosine in [−1, 1]; P_l(1) = 1.
std::vector<double> legendre(double cosine, int degree);

/// Σ_m f_lm² of each band: what a rotation keeps. `coefficients`: [(n + 1)²] of one signal, n ≤
/// kLargestLightDegree, else CheckFailure.
std::vector<double> band_energies(std::span<const float> coefficients);

/// The degree n of a signal of (n + 1)² coefficients; CheckFailure when `count` is no such number,
/// or n is above kLargestLightDegree.
int degree_of_count(std::size_t count);

/// CheckFailure unless 0 ≤ degree ≤ kLargestLightDegree.
void check_degree(int degree);

}  // namespace sh
}  // namespace rimlight
