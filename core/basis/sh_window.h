#pragma once

#include <span>
#include <vector>

namespace rimlight::sh {

// Windows against ringing: band l of a signal times factors[l], factors[0] = 1, falling with l
// (scale_bands() of sh_zonal.h applies them). A light with a sharp edge or a small source, cut off
// after some degree, swings around its true value, and below zero beside a bright source.

enum class Window {
  none,     // 1
  hann,     // (1 + cos(π l/(degree + 1)))/2
  lanczos,  // sin(x)/x, x = π l/(degree + 1)
};

/// [degree + 1]. CheckFailure for a degree out of range.
std::vector<double> window_factors(Window window, int degree);

/// exp(−t l(l + 1)), t ≥ 0: what diffusing heat on the sphere for a time t does to the bands.
/// [degree + 1].
std::vector<double> diffusion_factors(double time, int degree);

/// How a window is fitted to a light.
struct RingingLimit {
  /// The reconstruction may be so far below zero, as a share of its mean.
  double share = 0.02;
};

struct FittedWindow {
  double time = 0;              // of the diffusion; 0 when the light needs no window
  std::vector<double> factors;  // [degree + 1]
  /// The reconstruction's least value on the directions, over its mean: without and with the
  /// window. 0 for a black light.
  double least_before = 0, least_after = 0;
};

/// The mildest diffusion under which the light, reconstructed, is nowhere below −share of its mean.
/// The idea to search for the weakest window that a light needs, instead of using one for all, is
/// Sloan's (2017, Deringing Spherical Harmonics); the family is ours: diffusing is convolving with
/// a positive kernel of integral one, so the least value only ever rises with t, and bisection
/// finds the one place where it meets the limit (to 1e-3 of t).
///   luminance  [(degree + 1)²], one signal: of all channels together, so that hues stay
/// The values are taken at the middles of a cube map of 4(degree + 1) texels a side, 0.35/(degree +
/// 1) from any direction at most: there the reconstruction can be lower by 6 % of its largest
/// absolute value at most (its second derivative along a great circle is at most degree² of that,
/// Bernstein), and mostly by less than 1 %.
/// Error (where "window of a light") when a coefficient is not finite, or when the mean is
/// negative, or zero under a light that is not black: then no window helps. CheckFailure unless 0 ≤
/// share ≤ 1.
FittedWindow fitted_window(std::span<const float> luminance, const RingingLimit& limit = {});

}  // namespace rimlight::sh
