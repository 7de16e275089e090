#include "core/import/cell_cutter.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/basis/cube_map.h"

namespace rimlight {
namespace {

/// A square where no more than these can be nearest is cut at once.
constexpr std::size_t kFew = 8;
/// Far below a texel it is cheaper to cut many cells at once than to halve on.
constexpr int kFineLevels = 6;
constexpr std::size_t kMany = 64;
/// Where many cells still meet (at a pole of a grid) so small a square goes to the nearest as a
/// whole.
constexpr int kDeepest = 20;
/// A cap's rim is cut straight inside a square: chords of h instead of arcs of a circle of radius r
/// leave out h²/6r² of its area.
constexpr double kRimStep = 2e-3;

int level_of_rim(double half_angle) {
  const double radius = std::max(std::sin(half_angle), 1e-4);
  return std::min(static_cast<int>(std::ceil(std::log2(2 / (kRimStep * radius)))), kDeepest);
}

}  // namespace

CellCutter::CellCutter(std::span<const Vec3d> directions, int texel_level, const SphericalCap& cap)
    : directions_(directions),
      texel_level_(texel_level),
      cap_(cap),
      cap_cosine_(std::cos(cap.half_angle)),
      rim_level_(level_of_rim(cap.half_angle)),
      candidates_(kDeepest + 2) {
  // A hemisphere's rim is a great circle, straight on every face: exactly so.
  if (std::abs(cap_cosine_) < 1e-12) cap_cosine_ = 0;
}

std::vector<CellPart> CellCutter::cut(const Square& square) {
  std::vector<std::uint32_t> all(directions_.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint32_t>(i);
  parts_.clear();
  visit(square, all);
  return std::move(parts_);
}

CellCutter::Bounds CellCutter::bounds(const Square& square) const {
  const double side = std::ldexp(2.0, -square.level);
  Bounds result{square.column * side - 1, square.row * side - 1, side, {}, 0};
  result.middle = cube::direction({square.face, result.x + 0.5 * side, result.y + 0.5 * side});
  // A square is convex on the sphere and less than a hemisphere: a corner is farthest.
  for (int corner = 0; corner < 4; ++corner) {
    const Vec3d at = cube::direction(
        {square.face, result.x + (corner & 1 ? side : 0), result.y + (corner & 2 ? side : 0)});
    result.radius = std::max(result.radius, length(at - result.middle));
  }
  result.radius *= 1 + 1e-9;
  return result;
}

CellCutter::Place CellCutter::place_in_cap(const Bounds& bounds) const {
  constexpr double kRounding = 1e-12;
  const double reach = 2 * std::asin(std::min(1.0, 0.5 * bounds.radius)) + kRounding;
  const double angle = cap_.angle_to(bounds.middle);
  if (angle + reach <= cap_.half_angle) return Place::inside;
  return angle - reach >= cap_.half_angle ? Place::outside : Place::across;
}

std::uint32_t CellCutter::nearest(const Vec3d& point,
                                  const std::vector<std::uint32_t>& candidates) const {
  std::uint32_t best = candidates.front();
  double most = dot(point, directions_[best]);
  for (const std::uint32_t one : candidates) {
    const double value = dot(point, directions_[one]);
    if (value > most) {
      most = value;
      best = one;
    }
  }
  return best;
}

void CellCutter::keep_possible(const Bounds& bounds, const std::vector<std::uint32_t>& above,
                               std::vector<std::uint32_t>& kept) const {
  const Vec3d& winner = directions_[nearest(bounds.middle, above)];
  kept.clear();
  for (const std::uint32_t one : above) {
    // Computed from the difference, so that it holds for directions very close to each other too.
    const Vec3d difference = winner - directions_[one];
    if (dot(bounds.middle, difference) > bounds.radius * length(difference)) continue;
    kept.push_back(one);
  }
}

bool CellCutter::is_leaf(const Square& square, std::size_t candidates, Place place) const {
  if (square.level < texel_level_) return false;
  if (square.level >= kDeepest) return true;
  if (place == Place::across && cap_cosine_ != 0 && square.level < rim_level_) return false;
  return candidates <= (square.level < texel_level_ + kFineLevels ? kFew : kMany);
}

void CellCutter::visit(const Square& square, const std::vector<std::uint32_t>& above) {
  const Bounds at = bounds(square);
  const Place place = place_in_cap(at);
  if (place == Place::outside) return;
  auto& candidates = candidates_[static_cast<std::size_t>(square.level)];
  keep_possible(at, above, candidates);
  const std::size_t first_part = parts_.size();
  if (is_leaf(square, candidates.size(), place)) {
    cut_leaf(square, at, place, candidates);
  } else {
    for (std::uint32_t child = 0; child < 4; ++child) {
      visit({square.face, square.level + 1, 2 * square.column + (child & 1),
             2 * square.row + (child >> 1)},
            candidates);
    }
  }
  if (square.level == texel_level_) finish_texel(first_part);
}

void CellCutter::cut_leaf(const Square& square, const Bounds& at, Place place,
                          const std::vector<std::uint32_t>& candidates) {
  const cube::FaceAxes& axes = cube::face_axes(square.face);
  const int shift = square.level - texel_level_;
  const auto texel = static_cast<std::uint32_t>(
      (((static_cast<std::uint32_t>(square.face) << texel_level_) + (square.row >> shift))
       << texel_level_) +
      (square.column >> shift));
  const bool crowded = candidates.size() > kMany;
  const std::uint32_t winner = crowded ? nearest(at.middle, candidates) : 0;
  for (const std::uint32_t one : candidates) {
    if (crowded && one != winner) continue;
    polygon_.begin(at.x, at.y, at.side);
    if (place == Place::across) {
      const Vec3d axis(dot(cap_.axis, axes.right), dot(cap_.axis, axes.up),
                       dot(cap_.axis, axes.axis));
      polygon_.clip([&](const FacePolygon::Point& p) {
        return axis.x * p.x + axis.y * p.y + axis.z -
               cap_cosine_ * std::sqrt(1 + p.x * p.x + p.y * p.y);
      });
    }
    for (const std::uint32_t other : candidates) {
      if (other == one || crowded) continue;
      const Vec3d difference = directions_[one] - directions_[other];
      const double x = dot(difference, axes.right), y = dot(difference, axes.up);
      const double z = dot(difference, axes.axis);
      polygon_.clip([=](const FacePolygon::Point& p) { return x * p.x + y * p.y + z; });
    }
    const double solid_angle = polygon_.empty() ? 0 : polygon_.solid_angle();
    if (solid_angle > 0) parts_.push_back({one, texel, solid_angle});
  }
}

/// Joins the parts that one direction has in the texel's squares.
void CellCutter::finish_texel(std::size_t first_part) {
  const auto begin = parts_.begin() + static_cast<std::ptrdiff_t>(first_part);
  std::stable_sort(begin, parts_.end(),
                   [](const CellPart& a, const CellPart& b) { return a.direction < b.direction; });
  auto end = begin;
  for (auto at = begin; at != parts_.end(); ++at) {
    if (end != begin && (end - 1)->direction == at->direction) {
      (end - 1)->solid_angle += at->solid_angle;
    } else {
      *end++ = *at;
    }
  }
  parts_.erase(end, parts_.end());
}

}  // namespace rimlight
