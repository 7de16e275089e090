#include "core/curves/curve_session.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"

namespace rimlight {
namespace {

double between(double from, double to, double share) { return from + share * (to - from); }

double value_between(double from, double to, double share, CurveScale scale) {
  if (scale == CurveScale::linear || from == to) return between(from, to, share);
  const double low = std::log(std::max(from, kSmallestCurveValue));
  const double high = std::log(std::max(to, kSmallestCurveValue));
  return std::min(std::exp(between(low, high, share)), std::max(from, to));
}

}  // namespace

CurveEdit CurveStroke::at(int step) const {
  if (step >= frames - 1) return to;
  const double x = static_cast<double>(step + 1) / frames;
  const double share = x * x * (3 - 2 * x);
  CurveEdit curve = from;
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    CurvePoint& point = curve.points[i];
    point.position = between(point.position, to.points[i].position, share);
    for (int c = 0; c < 3; ++c) {
      point.value[c] = value_between(point.value[c], to.points[i].value[c], share, curve.scale);
    }
  }
  return curve;
}

int CurveSession::frame_count() const {
  int count = 0;
  for (const CurveStroke& stroke : strokes) count += stroke.frame_count();
  return count;
}

CurveSession::Place CurveSession::place(int frame) const {
  RIMLIGHT_CHECK(frame >= 0 && frame < frame_count());
  std::size_t stroke = 0;
  while (frame >= strokes[stroke].frame_count()) frame -= strokes[stroke++].frame_count();
  return {stroke, frame, frame < strokes[stroke].frames};
}

std::vector<std::string> CurveSession::materials() const {
  std::vector<std::string> names;
  for (const CurveStroke& stroke : strokes) {
    if (std::ranges::count(names, stroke.material) == 0) names.push_back(stroke.material);
  }
  return names;
}

}  // namespace rimlight
