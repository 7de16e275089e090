#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/material/brdf_curve.h"

namespace rimlight {

/// How values between points go: linearly in the value, or in its logarithm.
enum class CurveScale { linear, logarithmic };

/// A point that a person drags. Its position in [0, 1] runs over the bins: angle
/// bin_begin(axis, 256 · position).
struct CurvePoint {
  double position = 0;
  Vec3d value;

  friend bool operator==(const CurvePoint&, const CurvePoint&) = default;
};

inline constexpr std::size_t kMostCurvePoints = kCurveBins;
inline constexpr double kLargestCurveValue = 1e6;
/// On the logarithmic scale what is lower is drawn as this; a result at it is 0.
inline constexpr double kSmallestCurveValue = 1e-9;

/// Throws Error naming `where` and the point unless there are 1 … kMostCurvePoints points at rising
/// positions in [0, 1] with finite values in [0, kLargestCurveValue].
void check_curve_points(std::span<const CurvePoint> points, const std::string& where);
/// Throws Error unless there are kCurveBins values, finite, in [0, kLargestCurveValue].
void check_curve_values(std::span<const Vec3d> values, const std::string& where);

/// The piecewise cubic through given points that is monotone wherever they are, and so never
/// overshoots (Fritsch and Carlson 1980; slopes at the points by Fritsch and Butland's weighted
/// harmonic mean, 1984). Constant before the first point and after the last.
class MonotoneInterpolant {
 public:
  /// `x` rises strictly; as many `y`; at least one.
  MonotoneInterpolant(std::vector<double> x, std::vector<double> y);

  double at(double x) const;

 private:
  std::vector<double> x_, y_, slope_;
};

/// The curve through the points: bin averages of the interpolant over its position (4
/// Gauss–Legendre points a bin), channel by channel. Checks the points (Error).
BrdfCurve curve_from_points(CurveAxis axis, CurveScale scale, std::span<const CurvePoint> points,
                            const std::string& where);

}  // namespace rimlight
