#include "core/material/curve_points.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/math/quadrature.h"

namespace rimlight {
namespace {

std::string text_of(const Vec3d& v) {
  return "[" + std::to_string(v.x) + ", " + std::to_string(v.y) + ", " + std::to_string(v.z) + "]";
}

void check_value(const Vec3d& value, const std::string& where) {
  for (int c = 0; c < 3; ++c) {
    if (value[c] >= 0 && value[c] <= kLargestCurveValue) continue;
    throw Error(where, text_of(value), "values from 0 to 1000000");
  }
}

/// A slope at the end of the outer interval, from it and its neighbour: three-point formula, kept
/// from overshooting.
double end_slope(double h, double next_h, double secant, double next_secant) {
  const double slope = ((2 * h + next_h) * secant - h * next_secant) / (h + next_h);
  if (!(slope * secant > 0)) return 0;
  if (secant * next_secant <= 0 && std::abs(slope) > 3 * std::abs(secant)) return 3 * secant;
  return slope;
}

std::vector<double> monotone_slopes(const std::vector<double>& x, const std::vector<double>& y) {
  const std::size_t count = x.size();
  std::vector<double> slope(count);
  if (count < 2) return slope;
  std::vector<double> h(count - 1), secant(count - 1);
  for (std::size_t i = 0; i + 1 < count; ++i) {
    h[i] = x[i + 1] - x[i];
    secant[i] = (y[i + 1] - y[i]) / h[i];
  }
  if (count == 2) return {secant[0], secant[0]};
  for (std::size_t i = 1; i + 1 < count; ++i) {
    if (!(secant[i - 1] * secant[i] > 0)) continue;  // an extremum: flat
    const double before = 2 * h[i] + h[i - 1], after = h[i] + 2 * h[i - 1];
    slope[i] = (before + after) / (before / secant[i - 1] + after / secant[i]);
  }
  slope.front() = end_slope(h[0], h[1], secant[0], secant[1]);
  slope.back() = end_slope(h[count - 2], h[count - 3], secant[count - 2], secant[count - 3]);
  return slope;
}

/// One channel's average in a bin.
double bin_average(const MonotoneInterpolant& curve, CurveScale scale, std::size_t bin) {
  static const std::vector<QuadraturePoint> points = gauss_legendre(4);
  double sum = 0;
  for (const QuadraturePoint& point : points) {
    const double position = (static_cast<double>(bin) + 0.5 * (1 + point.position)) / kCurveBins;
    const double y = curve.at(position);
    if (scale == CurveScale::linear) {
      sum += 0.5 * point.weight * y;
    } else if (y > std::log(kSmallestCurveValue) + 1e-12) {
      sum += 0.5 * point.weight * std::exp(y);
    }
  }
  return sum;
}

}  // namespace

void check_curve_points(std::span<const CurvePoint> points, const std::string& where) {
  if (points.empty() || points.size() > kMostCurvePoints) {
    throw Error(where, std::to_string(points.size()) + " points", "1 to 256 points");
  }
  double last = -1;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::string here = where + "/" + std::to_string(i);
    const double position = points[i].position;
    if (!(position >= 0 && position <= 1 && position > last)) {
      throw Error(here, "a position of " + std::to_string(position),
                  "one in [0, 1], beyond the point before");
    }
    last = position;
    check_value(points[i].value, here);
  }
}

void check_curve_values(std::span<const Vec3d> values, const std::string& where) {
  if (values.size() != kCurveBins) {
    throw Error(where, std::to_string(values.size()) + " bins", "256 bins");
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    check_value(values[i], where + "/" + std::to_string(i));
  }
}

MonotoneInterpolant::MonotoneInterpolant(std::vector<double> x, std::vector<double> y)
    : x_(std::move(x)), y_(std::move(y)) {
  RIMLIGHT_CHECK(!x_.empty());
  RIMLIGHT_CHECK_EQ(x_.size(), y_.size());
  for (std::size_t i = 1; i < x_.size(); ++i) RIMLIGHT_CHECK(x_[i - 1] < x_[i]);
  slope_ = monotone_slopes(x_, y_);
}

double MonotoneInterpolant::at(double x) const {
  if (!(x > x_.front())) return y_.front();
  if (!(x < x_.back())) return y_.back();
  const auto after = std::upper_bound(x_.begin(), x_.end(), x);
  const std::size_t i = static_cast<std::size_t>(after - x_.begin()) - 1;
  const double h = x_[i + 1] - x_[i];
  const double t = (x - x_[i]) / h;
  const double s = 1 - t;
  // Hermite's cubic, and what rounding takes beyond the points clamped away.
  const double y = s * s * ((1 + 2 * t) * y_[i] + t * h * slope_[i]) +
                   t * t * ((1 + 2 * s) * y_[i + 1] - s * h * slope_[i + 1]);
  return std::clamp(y, std::min(y_[i], y_[i + 1]), std::max(y_[i], y_[i + 1]));
}

BrdfCurve curve_from_points(CurveAxis axis, CurveScale scale, std::span<const CurvePoint> points,
                            const std::string& where) {
  check_curve_points(points, where);
  BrdfCurve curve{axis, {}};
  for (int c = 0; c < 3; ++c) {
    std::vector<double> x, y;
    for (const CurvePoint& point : points) {
      const double value = point.value[c];
      x.push_back(point.position);
      y.push_back(scale == CurveScale::linear ? value
                                              : std::log(std::max(value, kSmallestCurveValue)));
    }
    const MonotoneInterpolant interpolant(std::move(x), std::move(y));
    for (std::size_t bin = 0; bin < kCurveBins; ++bin) {
      curve.values[bin][c] = static_cast<float>(bin_average(interpolant, scale, bin));
    }
  }
  return curve;
}

}  // namespace rimlight
