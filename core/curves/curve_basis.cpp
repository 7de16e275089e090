#include "core/curves/curve_basis.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/check.h"

namespace rimlight {
namespace {

/// Bins below, of less than 0.0015 rad, weigh as much as this one: no texel resolves them, and a
/// single quarter of one that meets the first bin would make its row's coefficients so large that
/// they drown all others of the panel.
constexpr std::size_t kNarrowestBin = 8;

/// ∝ the solid angle of half vectors in a bin of θ_h.
double solid_angle(std::size_t bin) {
  const double begin = bin_begin(CurveAxis::half_angle, static_cast<double>(bin));
  const double end = bin_begin(CurveAxis::half_angle, static_cast<double>(bin + 1));
  // cos a − cos b, without cancelling where both are small.
  return 2 * std::sin((begin + end) / 2) * std::sin((end - begin) / 2);
}

}  // namespace

CurveBasis::CurveBasis(CurveAxis axis) : axis_(axis), wavelets_(kCurveBins) {
  for (std::size_t bin = 0; bin < kCurveBins; ++bin) {
    // All solid angles sum to 1.
    const double share = solid_angle(std::max(bin, kNarrowestBin));
    weight_[bin] =
        axis == CurveAxis::half_angle ? std::sqrt(share * static_cast<double>(kCurveBins)) : 1;
  }
}

CurveCoefficients CurveBasis::coefficients(const BrdfCurve& curve) const {
  RIMLIGHT_CHECK(curve.axis == axis_);
  std::array<double, 3 * kCurveBins> weighted, transformed;
  for (std::size_t i = 0; i < weighted.size(); ++i) {
    weighted[i] = curve.values[i / 3][static_cast<int>(i % 3)] * weight_[i / 3];
  }
  wavelets_.forward(std::span<double>(weighted), std::span<double>(transformed), 3);
  CurveCoefficients result;
  for (std::size_t i = 0; i < transformed.size(); ++i) {
    result[i / 3][static_cast<int>(i % 3)] = static_cast<float>(transformed[i]);
  }
  return result;
}

BrdfCurve CurveBasis::curve(const CurveCoefficients& coefficients) const {
  std::array<double, 3 * kCurveBins> transformed, weighted;
  for (std::size_t i = 0; i < transformed.size(); ++i) {
    transformed[i] = coefficients[i / 3][static_cast<int>(i % 3)];
  }
  wavelets_.inverse(std::span<const double>(transformed), std::span<double>(weighted), 3);
  BrdfCurve result{axis_, {}};
  for (std::size_t i = 0; i < weighted.size(); ++i) {
    result.values[i / 3][static_cast<int>(i % 3)] =
        static_cast<float>(weighted[i] / weight_[i / 3]);
  }
  return result;
}

void CurveBasis::transform(std::span<float> bins, std::span<float> coefficients,
                           std::size_t lanes) const {
  RIMLIGHT_CHECK_EQ(bins.size(), kCurveBins * lanes);
  for (std::size_t bin = 0; bin < kCurveBins; ++bin) {
    const auto factor = static_cast<float>(1 / weight_[bin]);
    for (float& value : bins.subspan(bin * lanes, lanes)) value *= factor;
  }
  wavelets_.forward(bins, coefficients, lanes);
}

}  // namespace rimlight
