#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/basis/cube_map.h"

namespace rimlight {

/// A convex polygon in the plane of a cube face. Great circles are straight lines there, so an
/// intersection of half-spaces through the origin, such as a cell of a spherical Voronoi diagram or
/// a texel, is a polygon of this kind on each face. Keeps its storage when it is begun anew.
class FacePolygon {
 public:
  struct Point {
    double x = 0, y = 0;
  };

  /// Begins with the square from (x, y) to (x + side, y + side).
  void begin(double x, double y, double side) {
    points_.assign({{x, y}, {x + side, y}, {x + side, y + side}, {x, y + side}});
  }

  bool empty() const { return points_.size() < 3; }

  /// Keeps where inside(point) ≥ 0 (Sutherland and Hodgman 1974): exact when `inside` is linear in
  /// x and y. Two polygons cut along one line, each on its side, share their new corners bit for
  /// bit.
  template <typename Inside>
  void clip(const Inside& inside) {
    // Most cuts miss: nothing is copied then.
    double least = 0;
    for (const Point& point : points_) least = std::min(least, inside(point));
    if (least >= 0) return;
    kept_.clear();
    if (!empty()) {
      Point a = points_.back();
      double at_a = inside(a);
      for (const Point& b : points_) {
        const double at_b = inside(b);
        if ((at_a > 0 && at_b < 0) || (at_a < 0 && at_b > 0)) {
          const double t = at_a / (at_a - at_b);
          kept_.push_back({a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t});
        }
        if (at_b >= 0) kept_.push_back(b);
        a = b;
        at_a = at_b;
      }
    }
    points_.swap(kept_);
  }

  /// In steradians, with a relative error of some roundings however small the polygon: a fan of
  /// triangles, each by Van Oosterom and Strackee 1983, tan(Ω/2) = a·(b×c) / (|a||b||c| +
  /// (a·b)|c| + (b·c)|a| + (c·a)|b|), whose numerator is twice the triangle's plane area here.
  double solid_angle() const;

 private:
  std::vector<Point> points_;  // counter-clockwise
  std::vector<Point> kept_;
};

}  // namespace rimlight
