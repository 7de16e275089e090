#include "core/light/soft_disc.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/check.h"
#include "core/math/quadrature.h"

namespace rimlight {
namespace {

/// To 1e-6 of a texel even where the edge's whole ramp lies within it.
constexpr int kQuadraturePoints = 12;

/// 1 − cos r, exact for small r too.
double one_minus_cosine(double r) { return 2 * std::pow(std::sin(r / 2), 2); }

/// The arc of a great circle from one unit vector to another less than 180 degrees away:
/// P(t) = from cos t + along sin t.
struct Arc {
  Vec3d from, to;
  Vec3d normal;  // from × along
  Vec3d along;
  double length;

  Arc(const Vec3d& a, const Vec3d& b) : from(a), to(b) {
    const Vec3d across = cross(a, b);
    const double sine = rimlight::length(across);
    normal = across / sine;
    along = cross(normal, a);
    length = std::atan2(sine, dot(a, b));
  }
  Vec3d at(double t) const {
    if (t <= 0) return from;
    if (t >= length) return to;
    return from * std::cos(t) + along * std::sin(t);
  }
};

/// A part of an arc; empty when begin ≥ end.
struct Interval {
  double begin, end;
};

/// Rows and columns of a face.
struct Block {
  int face;
  int column, column_end;
  int row, row_end;
};

/// One disc on its way into the texels.
class DiscAdder {
 public:
  DiscAdder(const SoftDisc& disc, const Vec3d& radiance, CubeLight& light)
      : middle_(disc.direction),
        radiance_(radiance),
        light_(light),
        height_(one_minus_cosine(disc.angular_radius)),
        low_(1 - height_ * (1 + disc.edge)),
        high_(1 - height_ * (1 - disc.edge)),
        reach_(2 * std::asin(std::sqrt(height_ * (1 + disc.edge) / 2))) {}

  void add(const Block& block) const;

 private:
  /// Of a block, to the disc.
  enum class Place { outside, inside, across };

  std::array<Vec3d, 4> corners_of(const Block& block) const;
  Place place_of(const std::array<Vec3d, 4>& corners) const;
  void fill(const Block& block, double share) const;
  double border_integral(const Arc& arc) const;
  double edge_integral(const Interval& part, double sine, double cosine, double nearest) const;
  double angle_about_middle(const Vec3d& a, const Vec3d& b) const;
  double triangle(const Vec3d& a, const Vec3d& b) const;

  Vec3d middle_;
  Vec3d radiance_;
  CubeLight& light_;
  double height_;      // 1 − cos r: F at low and below
  double low_, high_;  // cosines where the edge begins and ends
  double reach_;       // the angle of `low`
};

/// The angle φ from a to b as seen from the disc's middle, counter-clockwise from outside.
double DiscAdder::angle_about_middle(const Vec3d& a, const Vec3d& b) const {
  return std::atan2(dot(middle_, cross(a, b)), dot(a, b) - dot(middle_, a) * dot(middle_, b));
}

/// The signed solid angle of the triangle (middle, a, b) (Van Oosterom and Strackee 1983).
double DiscAdder::triangle(const Vec3d& a, const Vec3d& b) const {
  return 2 *
         std::atan2(dot(middle_, cross(a, b)), 1 + dot(middle_, a) + dot(a, b) + dot(b, middle_));
}

/// ∫ (1 − z − F(z)) dφ over a part of an arc on the edge, where 1 − z − F = H (v³ − v⁴/2),
/// v = (high − z) / H, H = high − low. With z = C cos(t − nearest) and s = middle · normal,
/// dφ = s dt / (s² + C² sin²(t − nearest)).
double DiscAdder::edge_integral(const Interval& part, double sine, double cosine,
                                double nearest) const {
  static const std::vector<QuadraturePoint> points = gauss_legendre(kQuadraturePoints);
  if (!(part.begin < part.end)) return 0;
  const double half = 0.5 * (part.end - part.begin);
  const double centre = 0.5 * (part.end + part.begin) - nearest;
  const double width = high_ - low_;
  double sum = 0;
  for (const QuadraturePoint& point : points) {
    const double t = centre + half * point.position;
    const double v = std::clamp((high_ - cosine * std::cos(t)) / width, 0.0, 1.0);
    const double beyond = cosine * std::sin(t);
    sum += point.weight * v * v * v * (1 - 0.5 * v) / (sine * sine + beyond * beyond);
  }
  return sum * half * width * sine;
}

/// ∮ F(z) dφ along one side of a texel: outside the disc F is constant; inside it is 1 − z, which
/// makes a spherical triangle; on the edge what is missing from that is taken off.
double DiscAdder::border_integral(const Arc& arc) const {
  const double sine = dot(middle_, arc.normal);
  const double x = dot(middle_, arc.from), y = dot(middle_, arc.along);
  const double cosine = std::hypot(x, y);   // z of the nearest point of the great circle,
  const double nearest = std::atan2(y, x);  // which lies here
  const auto within = [&](double z) -> Interval {
    if (!(cosine > z)) return {arc.length, arc.length};
    const double half = std::acos(z / cosine);
    return {std::clamp(nearest - half, 0.0, arc.length),
            std::clamp(nearest + half, 0.0, arc.length)};
  };
  const Interval disc = within(low_);
  if (!(disc.begin < disc.end)) return height_ * angle_about_middle(arc.from, arc.to);
  const Vec3d entry = arc.at(disc.begin), exit = arc.at(disc.end);
  double sum = triangle(entry, exit);
  if (disc.begin > 0) sum += height_ * angle_about_middle(arc.from, entry);
  if (disc.end < arc.length) sum += height_ * angle_about_middle(exit, arc.to);
  if (!(low_ < high_)) return sum;
  Interval core = within(high_);
  // Split where the great circle is nearest, about which the integrand is even.
  if (!(core.begin < core.end)) {
    core.begin = core.end = std::clamp(nearest, disc.begin, disc.end);
  }
  return sum - edge_integral({disc.begin, core.begin}, sine, cosine, nearest) -
         edge_integral({core.end, disc.end}, sine, cosine, nearest);
}

/// The corners' directions, counter-clockwise from outside.
std::array<Vec3d, 4> DiscAdder::corners_of(const Block& block) const {
  const auto corner = [&](int column, int row) {
    return cube::direction(
        {block.face, 2.0 * column / light_.size - 1, 2.0 * row / light_.size - 1});
  };
  return {corner(block.column, block.row), corner(block.column_end, block.row),
          corner(block.column_end, block.row_end), corner(block.column, block.row_end)};
}

DiscAdder::Place DiscAdder::place_of(const std::array<Vec3d, 4>& corners) const {
  const Vec3d centre = normalized(corners[0] + corners[1] + corners[2] + corners[3]);
  double widest = 1, farthest = 1;  // cosines
  for (const Vec3d& corner : corners) {
    widest = std::min(widest, dot(centre, corner));
    farthest = std::min(farthest, dot(middle_, corner));
  }
  // A little more, so that rounding never leaves out a texel that the disc touches.
  constexpr double kRounding = 1e-12;
  if (dot(middle_, centre) < std::cos(reach_ + std::acos(widest)) - kRounding) {
    return Place::outside;
  }
  return farthest >= high_ ? Place::inside : Place::across;
}

void DiscAdder::fill(const Block& block, double share) const {
  for (int row = block.row; row < block.row_end; ++row) {
    const int first = (block.face * light_.size + row) * light_.size;
    for (int c = 0; c < 3; ++c) {
      float* const texels = light_.channel(c).data() + first;
      const auto radiance = static_cast<float>(share * radiance_[c]);
      for (int column = block.column; column < block.column_end; ++column) {
        texels[column] += radiance;
      }
    }
  }
}

/// Halves the block until it is outside, inside, or one texel.
void DiscAdder::add(const Block& block) const {
  const std::array<Vec3d, 4> corners = corners_of(block);
  const Place place = place_of(corners);
  if (place == Place::outside) return;
  if (place == Place::inside) return fill(block, 1);
  const int columns = block.column_end - block.column, rows = block.row_end - block.row;
  if (columns == 1 && rows == 1) {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      sum += border_integral(Arc(corners[i], corners[(i + 1) % 4]));
    }
    const int texel = (block.face * light_.size + block.row) * light_.size + block.column;
    const double whole = cube::texel_solid_angle(static_cast<std::size_t>(texel), light_.size);
    return fill(block, std::clamp(sum / whole, 0.0, 1.0));
  }
  Block low = block, high = block;
  if (columns >= rows) {
    low.column_end = high.column = block.column + columns / 2;
  } else {
    low.row_end = high.row = block.row + rows / 2;
  }
  add(low);
  add(high);
}

}  // namespace

double solid_angle(const SoftDisc& disc) {
  return 2 * std::numbers::pi * one_minus_cosine(disc.angular_radius);
}

void add_disc(const SoftDisc& disc, const Vec3d& radiance, CubeLight& light) {
  constexpr double kRounding = 1e-9;
  RIMLIGHT_CHECK(light.size >= 2 && light.size <= cube::kLargestSize);
  RIMLIGHT_CHECK(std::abs(length(disc.direction) - 1) <= kRounding);
  RIMLIGHT_CHECK(disc.angular_radius > 0 && disc.angular_radius <= kWidestDisc + kRounding);
  RIMLIGHT_CHECK(disc.edge >= 0 && disc.edge <= 1);
  const DiscAdder adder(disc, radiance, light);
  for (int face = 0; face < cube::kFaces; ++face) adder.add({face, 0, light.size, 0, light.size});
}

}  // namespace rimlight
