#include "core/bake/diffusion_dipole.h"

#include <cmath>
#include <numbers>

#include "core/base/check.h"

namespace rimlight {
namespace {

constexpr double kInverse4Pi = std::numbers::inv_pi / 4;

/// z (1 + σ d) e^(−σ d) / d³.
double pole(double depth, double falloff, double distance) {
  const double d = std::hypot(distance, depth);
  return depth * (1 + falloff * d) * std::exp(-falloff * d) / (d * d * d);
}

double boundary_factor(double eta) {
  const double fresnel = -1.440 / (eta * eta) + 0.710 / eta + 0.668 + 0.0636 * eta;
  return (1 + fresnel) / (1 - fresnel);
}

}  // namespace

DiffusionDipole::DiffusionDipole(double absorption, double scattering, double eta)
    : albedo_(scattering / (absorption + scattering)),
      falloff_(std::sqrt(3 * absorption * (absorption + scattering))),
      real_depth_(1 / (absorption + scattering)),
      virtual_depth_(real_depth_ * (1 + 4 * boundary_factor(eta) / 3)),
      reflectance_(0) {
  RIMLIGHT_CHECK(absorption >= 0 && scattering > 0 && eta >= 1);
  reflectance_ = integral_from(real_depth_, 0) + integral_from(virtual_depth_, 0);
}

double DiffusionDipole::at(double distance) const {
  return albedo_ * kInverse4Pi *
         (pole(real_depth_, falloff_, distance) + pole(virtual_depth_, falloff_, distance));
}

/// ∫ over r > radius of one pole: α′/2 · z e^(−σ d)/d, since d/dd (e^(−σ d)/d) = −(1 + σ d) e^(−σ
/// d)/d².
double DiffusionDipole::integral_from(double depth, double radius) const {
  const double d = std::hypot(radius, depth);
  return albedo_ / 2 * depth * std::exp(-falloff_ * d) / d;
}

double DiffusionDipole::within(double radius) const {
  return reflectance_ - integral_from(real_depth_, radius) - integral_from(virtual_depth_, radius);
}

double DiffusionDipole::reach(double share) const {
  double low = 0, high = virtual_depth_;
  while (reflectance_ - within(high) > share * reflectance_) high *= 2;
  for (int i = 0; i < 40; ++i) {
    const double middle = (low + high) / 2;
    (reflectance_ - within(middle) > share * reflectance_ ? low : high) = middle;
  }
  return high;
}

DiffusionDipole dipole_of(const Subsurface& medium, int channel) {
  return {medium.absorption[channel], medium.scattering[channel], medium.eta};
}

}  // namespace rimlight
