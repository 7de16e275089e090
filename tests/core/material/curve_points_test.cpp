#include "core/material/curve_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/base/error.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

using Vector = std::vector<double>;

Vec3d grey(double value) { return Vec3d::filled(value); }

TEST(MonotoneInterpolant, NeverOvershoots) {
  Random random(41);
  for (int round = 0; round < 500; ++round) {
    Vector x{0}, y{random.uniform()};
    const std::size_t count = 1 + random.below(12);
    while (x.size() <= count) {
      x.push_back(x.back() + std::pow(10, random.uniform(-6, 0)));
      y.push_back(round % 3 == 0 ? y.back() + random.uniform() : random.uniform() * 1e6);
    }
    const MonotoneInterpolant curve(x, y);
    for (std::size_t i = 0; i + 1 < x.size(); ++i) {
      double last = y[i];
      const double direction = y[i + 1] > y[i] ? 1 : -1;
      ASSERT_EQ(curve.at(x[i]), y[i]);
      for (int step = 1; step < 20; ++step) {
        const double value = curve.at(x[i] + (x[i + 1] - x[i]) * step / 20);
        ASSERT_GE(direction * (value - last), -1e-9 * std::abs(y[i] - y[i + 1]));
        ASSERT_GE(value, std::min(y[i], y[i + 1]));
        ASSERT_LE(value, std::max(y[i], y[i + 1]));
        last = value;
      }
    }
    EXPECT_EQ(curve.at(x.front() - 1), y.front());
    EXPECT_EQ(curve.at(x.back() + 1), y.back());
  }
}

TEST(MonotoneInterpolant, IsALineThroughPointsOfALine) {
  const MonotoneInterpolant curve({0, 0.1, 0.5, 2}, {1, 1.3, 2.5, 7});
  for (double x = 0; x < 2; x += 0.07) EXPECT_NEAR(curve.at(x), 1 + 3 * x, 1e-14);
}

TEST(MonotoneInterpolant, HasNoCorners) {
  const MonotoneInterpolant curve({0, 1, 1.5, 3, 4}, {0, 2, 2.2, 9, 3});
  for (const double x : {1.0, 1.5, 3.0}) {
    const double step = 1e-6;
    EXPECT_NEAR((curve.at(x) - curve.at(x - step)) / step,
                (curve.at(x + step) - curve.at(x)) / step, 1e-4);
  }
  EXPECT_NEAR((curve.at(3) - curve.at(3 - 1e-6)) / 1e-6, 0, 1e-4);  // the summit is flat
}

TEST(CurvePoints, BinsHoldTheAveragesOfTheInterpolant) {
  const std::vector<CurvePoint> points{{0, grey(5)}, {0.3, grey(1)}, {0.31, grey(0)}, {1, grey(2)}};
  const BrdfCurve curve =
      curve_from_points(CurveAxis::difference_angle, CurveScale::linear, points, "points");
  EXPECT_EQ(curve.axis, CurveAxis::difference_angle);
  const MonotoneInterpolant interpolant({0, 0.3, 0.31, 1}, {5, 1, 0, 2});
  for (std::size_t bin = 0; bin < kCurveBins; ++bin) {
    double sum = 0;
    for (int i = 0; i < 1000; ++i) {
      sum += interpolant.at((static_cast<double>(bin) + (i + 0.5) / 1000) / kCurveBins);
    }
    // Four points are exact for a cubic; a joint inside the bin costs more.
    const bool joint = bin == 76 || bin == 79;
    ASSERT_NEAR(curve.values[bin].x, sum / 1000, joint ? 0.02 : 1e-5) << bin;
  }
}

TEST(CurvePoints, LogarithmicScaleIsAPowerLawBetweenPoints) {
  const std::vector<CurvePoint> points{{0, {1e6, 1, 0}}, {1, {1, 1e-3, 0}}};
  const BrdfCurve curve =
      curve_from_points(CurveAxis::half_angle, CurveScale::logarithmic, points, "points");
  for (std::size_t bin = 0; bin < kCurveBins; ++bin) {
    const double position = (static_cast<double>(bin) + 0.5) / kCurveBins;
    ASSERT_NEAR(curve.values[bin].x / std::pow(1e6, 1 - position), 1, 2e-4);
    ASSERT_NEAR(curve.values[bin].y / std::pow(1e-3, position), 1, 2e-4);
    ASSERT_EQ(curve.values[bin].z, 0);  // zero on the logarithmic scale stays zero
  }
}

TEST(CurvePoints, OnePointIsAConstantAndAJumpStaysInItsBin) {
  const std::vector<CurvePoint> one{{0.4, {1, 0, 1e6}}};
  for (const CurveScale scale : {CurveScale::linear, CurveScale::logarithmic}) {
    for (const Vec3f& v : curve_from_points(CurveAxis::half_angle, scale, one, "p").values) {
      ASSERT_NEAR(v.x, 1, 1e-6);
      ASSERT_EQ(v.y, 0);
      ASSERT_NEAR(v.z, 1e6, 1);
    }
  }
  const std::vector<CurvePoint> jump{
      {0, grey(0)}, {0.5, grey(0)}, {std::nextafter(0.5, 1), grey(1e6)}, {1, grey(1e6)}};
  const BrdfCurve curve =
      curve_from_points(CurveAxis::half_angle, CurveScale::linear, jump, "points");
  EXPECT_EQ(curve.values[127].x, 0);
  EXPECT_EQ(curve.values[128].x, 1e6f);
}

TEST(CurvePoints, RefusesWhatIsNoCurve) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](const std::vector<CurvePoint>& points) {
    try {
      curve_from_points(CurveAxis::half_angle, CurveScale::linear, points,
                        "material.curve: /points");
    } catch (const Error& error) {
      return error.where();
    }
    return std::string("accepted");
  };
  EXPECT_EQ(refused({}), "material.curve: /points");
  EXPECT_EQ(refused(std::vector<CurvePoint>(257)), "material.curve: /points");
  EXPECT_EQ(refused({{0, grey(1)}, {0, grey(1)}}), "material.curve: /points/1");
  EXPECT_EQ(refused({{0.5, grey(1)}, {0.4, grey(1)}}), "material.curve: /points/1");
  EXPECT_EQ(refused({{1.5, grey(1)}}), "material.curve: /points/0");
  EXPECT_EQ(refused({{kNan, grey(1)}}), "material.curve: /points/0");
  EXPECT_EQ(refused({{0, {1, kNan, 1}}}), "material.curve: /points/0");
  EXPECT_EQ(refused({{0, grey(-1e-3)}}), "material.curve: /points/0");
  EXPECT_EQ(refused({{0, grey(1.1e6)}}), "material.curve: /points/0");
  EXPECT_EQ(refused({{0, grey(1e6)}}), "accepted");
}

TEST(CurvePoints, ValuesAreExactly256AndFinite) {
  std::vector<Vec3d> values(256);
  EXPECT_NO_THROW(check_curve_values(values, "v"));
  values[7].y = std::numeric_limits<double>::infinity();
  EXPECT_THROW(check_curve_values(values, "v"), Error);
  values.assign(257, {});
  EXPECT_THROW(check_curve_values(values, "v"), Error);
  values.assign(255, {});
  EXPECT_THROW(check_curve_values(values, "v"), Error);
}

}  // namespace
}  // namespace rimlight
