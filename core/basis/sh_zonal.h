#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/math/vec.h"

namespace rimlight::sh {

/// A function on the sphere that is symmetric about +z, a *lobe*: its coefficients of m = 0 only,
/// [degree + 1], f_l0 = 2π √((2l + 1)/4π) ∫ f(t) P_l(t) dt over t = cos θ in [−1, 1]. In double.
using ZonalLobe = std::vector<double>;

/// max(t, 0): what a Lambertian surface sees; its integral is π. Analytic for every degree: odd
/// ones above 1 are 0 (Ramamoorthi and Hanrahan 2001).
ZonalLobe clamped_cosine_lobe(int degree);

/// (s + 1)/2π · max(t, 0)^s, whose integral is 1, for any finite exponent s ≥ 0. Analytic:
/// with I_l = ∫ t^s P_l dt over [0, 1], I_0 = 1/(s + 1), I_1 = 1/(s + 2) and
/// I_l = I_{l−2} · (s − l + 2)/(s + l + 1). CheckFailure for another exponent.
ZonalLobe phong_lobe(double exponent, int degree);

/// Any lobe, sampled at `points` Gauss–Legendre points on each of [−1, 0] and [0, 1] (lobes often
/// have a kink at the horizon): exact where it is a polynomial of degree 2·points − 1 − `degree` on
/// both. Error (where "lobe") when a value is not finite. CheckFailure when points < 1.
ZonalLobe sampled_lobe(const std::function<double(double cosine)>& lobe, int degree,
                       int points = 64);

/// The value of a lobe, Σ f_l0 Y_l0, at the cosine of the angle from its axis.
double lobe_value(std::span<const double> lobe, double cosine);

/// The coefficients, [(degree + 1)²], of a lobe that is turned from +z to an `axis` of any length
/// but zero: √(4π/(2l + 1)) f_l0 Y_lm(axis).
std::vector<double> turned_lobe(std::span<const double> lobe, const Vec3d& axis);

/// The convolution of signals with a lobe, (f ∗ h)(ω) = ∫ f(ω′) h(ω·ω′) dω′, in place: band l times
/// √(4π/(2l + 1)) h_l0.
///   signals  [signal][(n + 1)²], where n + 1 = lobe.size(); else CheckFailure
void convolve(std::span<const double> lobe, std::span<float> signals);

/// Multiplies band l of each signal by factors[l], in place; shapes as in convolve().
void scale_bands(std::span<const double> factors, std::span<float> signals);

}  // namespace rimlight::sh
