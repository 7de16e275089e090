#pragma once

#include <span>
#include <vector>

#include "core/math/vec.h"

namespace rimlight {

/// From reflectances at given wavelengths to linear RGB with sRGB's primaries, under daylight (CIE
/// D65) seen by the CIE 1931 observer. A surface that reflects all light is (1, 1, 1); saturated
/// ones may have a channel below 0. Between wavelengths the spectrum is linear, beyond the first
/// and last constant, from 400 to 700 nm in steps of 10.
class SpectrumToRgb {
 public:
  /// Wavelengths in nanometres, rising strictly; at least one.
  explicit SpectrumToRgb(std::span<const double> wavelengths);

  /// One reflectance for each wavelength.
  Vec3d rgb(std::span<const double> reflectances) const;

 private:
  std::vector<Vec3d> weights_;
};

/// The colour matching functions of the CIE 1931 observer at a wavelength in nanometres, by the
/// multi-lobe fit of Wyman, Sloan and Shirley (2013, JCGT 2(2)).
Vec3d colour_matching(double wavelength);

}  // namespace rimlight
