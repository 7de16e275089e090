#include "core/import/face_polygon.h"

#include <cmath>

namespace rimlight {
namespace {

/// The corner as a direction in the face's own axes: (x, y, 1).
double length_of(const FacePolygon::Point& p) { return std::sqrt(1 + p.x * p.x + p.y * p.y); }

double product(const FacePolygon::Point& p, const FacePolygon::Point& q) {
  return 1 + p.x * q.x + p.y * q.y;
}

double triangle_solid_angle(const FacePolygon::Point& a, const FacePolygon::Point& b,
                            const FacePolygon::Point& c) {
  const double twice_area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
  const double la = length_of(a), lb = length_of(b), lc = length_of(c);
  return 2 * std::atan2(twice_area, la * lb * lc + product(a, b) * lc + product(b, c) * la +
                                        product(c, a) * lb);
}

}  // namespace

double FacePolygon::solid_angle() const {
  double sum = 0;
  for (std::size_t i = 2; i < points_.size(); ++i) {
    sum += triangle_solid_angle(points_[0], points_[i - 1], points_[i]);
  }
  return sum;
}

}  // namespace rimlight
