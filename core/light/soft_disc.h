#pragma once

#include <numbers>

#include "core/light/cube_light.h"
#include "core/math/vec.h"

namespace rimlight {

/// The widest disc of light: with the softest edge it reaches 90 degrees, which is as far as a disc
/// is convex on the sphere.
inline constexpr double kWidestDisc = std::numbers::pi / 3;

/// A disc of light among the directions, of radiance 1 within and 0 without. Its edge is soft:
///
///   w(ω) = 3u² − 2u³, u = (z − low) / (high − low) clamped to [0, 1], z = ω · direction
///   low, high = cos r ∓ edge (1 − cos r)
///
/// w is odd about z = cos r, so the solid angle ∫ w dω is that of the sharp disc for any edge.
struct SoftDisc {
  Vec3d direction{0, 1, 0};   // unit
  double angular_radius = 0;  // r: radians, above 0, at most kWidestDisc
  double edge = 0;            // 0: sharp; 1: soft from the middle on
};

/// ∫ w dω = 2π (1 − cos r).
double solid_angle(const SoftDisc& disc);

/// Adds radiance times the mean of w over each texel; leaves alone the texels outside the disc. At
/// least 2 texels a side.
///
/// Nothing is sampled, so that no energy is lost or gained wherever the disc lies: by Stokes'
/// theorem, in polar coordinates (z, φ) about the disc's direction,
///
///   ∫ w dω over a texel = ∮ F(z) dφ around its border, F(z) = ∫ w dz from z to 1
///
/// in closed form where w is 0 or 1, by quadrature on the soft edge. Neighbouring texels share
/// their borders with opposite signs, so the sum over texels is right to rounding.
void add_disc(const SoftDisc& disc, const Vec3d& radiance, CubeLight& light);

}  // namespace rimlight
