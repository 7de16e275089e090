#include "core/material/spectrum.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"

namespace rimlight {
namespace {

constexpr double kFirst = 400, kStep = 10;
/// CIE standard illuminant D65, relative, from 400 to 700 nm.
constexpr double kDaylight[] = {82.75,  91.49,  93.43,  86.68,  104.86, 117.01, 117.81, 114.86,
                                115.92, 108.81, 109.35, 107.80, 104.79, 107.69, 104.41, 104.05,
                                100.00, 96.33,  95.79,  88.69,  90.01,  89.60,  87.70,  83.29,
                                83.70,  80.03,  80.21,  82.28,  78.28,  69.72,  71.61};

double lobe(double wavelength, double middle, double below, double above) {
  const double t = (wavelength - middle) / (wavelength < middle ? below : above);
  return std::exp(-0.5 * t * t);
}

/// CIE XYZ to linear RGB of sRGB's primaries (IEC 61966-2-1).
Vec3d rgb_of(const Vec3d& xyz) {
  return {dot(Vec3d(3.2406, -1.5372, -0.4986), xyz), dot(Vec3d(-0.9689, 1.8758, 0.0415), xyz),
          dot(Vec3d(0.0557, -0.2040, 1.0570), xyz)};
}

/// Adds `weight` of the spectrum at `wavelength` to the weights of the two samples beside it.
void spread(std::span<const double> wavelengths, double wavelength, const Vec3d& weight,
            std::vector<Vec3d>& weights) {
  const auto after = std::upper_bound(wavelengths.begin(), wavelengths.end(), wavelength);
  if (after == wavelengths.begin()) {
    weights.front() += weight;
  } else if (after == wavelengths.end()) {
    weights.back() += weight;
  } else {
    const auto i = static_cast<std::size_t>(after - wavelengths.begin());
    const double share = (wavelength - wavelengths[i - 1]) / (wavelengths[i] - wavelengths[i - 1]);
    weights[i - 1] += weight * (1 - share);
    weights[i] += weight * share;
  }
}

}  // namespace

Vec3d colour_matching(double wavelength) {
  const double w = wavelength;
  return {1.056 * lobe(w, 599.8, 37.9, 31.0) + 0.362 * lobe(w, 442.0, 16.0, 26.7) -
              0.065 * lobe(w, 501.1, 20.4, 26.2),
          0.821 * lobe(w, 568.8, 46.9, 40.5) + 0.286 * lobe(w, 530.9, 16.3, 31.1),
          1.217 * lobe(w, 437.0, 11.8, 36.0) + 0.681 * lobe(w, 459.0, 26.0, 13.8)};
}

SpectrumToRgb::SpectrumToRgb(std::span<const double> wavelengths) : weights_(wavelengths.size()) {
  RIMLIGHT_CHECK(!wavelengths.empty());
  Vec3d white;
  double at = kFirst;
  for (const double power : kDaylight) {
    const Vec3d weight = rgb_of(colour_matching(at) * power);
    spread(wavelengths, at, weight, weights_);
    white += weight;
    at += kStep;
  }
  // A flat spectrum is white to the last digit, whatever the fit and the table round.
  for (Vec3d& weight : weights_)
    weight = {weight.x / white.x, weight.y / white.y, weight.z / white.z};
}

Vec3d SpectrumToRgb::rgb(std::span<const double> reflectances) const {
  RIMLIGHT_CHECK_EQ(reflectances.size(), weights_.size());
  Vec3d sum;
  for (std::size_t i = 0; i < weights_.size(); ++i) sum += weights_[i] * reflectances[i];
  return sum;
}

}  // namespace rimlight
