#include "core/import/direction_cells.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/basis/cube_map.h"
#include "core/import/cell_cutter.h"

namespace rimlight {
namespace {

/// Work is shared out in squares of this level, 16 a face.
constexpr int kTaskLevel = 2;

/// For each direction the first that it coincides with (itself, if none).
std::vector<std::uint32_t> find_coincident(std::span<const Vec3d> directions) {
  // In order along an axis that no grid is square to, coincident ones stand close together.
  const Vec3d axis = normalized(Vec3d(0.5698, 0.3211, 0.7565));
  std::vector<std::uint32_t> order(directions.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint32_t>(i);
  std::vector<double> along(directions.size());
  for (std::size_t i = 0; i < along.size(); ++i) along[i] = dot(axis, directions[i]);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return along[a] != along[b] ? along[a] < along[b] : a < b;
  });
  std::vector<std::uint32_t> first(directions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::uint32_t one = order[i];
    first[one] = one;
    for (std::size_t j = i; j-- > 0 && along[one] - along[order[j]] <= kCoincident;) {
      const std::uint32_t other = order[j];
      if (first[other] != other) continue;
      if (length(directions[one] - directions[other]) > kCoincident) continue;
      first[one] = other;
      break;
    }
  }
  return first;
}

/// The cells' parts, task by task.
std::vector<CellPart> cut_all(std::span<const Vec3d> directions, int texel_level,
                              const SphericalCap& cap) {
  const int level = std::min(kTaskLevel, texel_level);
  const std::size_t side = std::size_t{1} << level;
  std::vector<std::vector<CellPart>> tasks(cube::kFaces * side * side);
  parallel_for(tasks.size(), [&](std::size_t task) {
    CellCutter cutter(directions, texel_level, cap);
    tasks[task] = cutter.cut({static_cast<int>(task / (side * side)), level,
                              static_cast<std::uint32_t>(task % side),
                              static_cast<std::uint32_t>(task / side % side)});
  });
  std::vector<CellPart> all;
  for (const auto& parts : tasks) all.insert(all.end(), parts.begin(), parts.end());
  return all;
}

}  // namespace

double SphericalCap::angle_to(const Vec3d& direction) const {
  return std::atan2(length(cross(axis, direction)), dot(axis, direction));
}

double SphericalCap::solid_angle() const {
  const double sine = std::sin(0.5 * half_angle);
  return 4 * std::numbers::pi * sine * sine;
}

DirectionCells::DirectionCells(std::span<const Vec3d> directions, int size, const SphericalCap& cap)
    : size_(size) {
  RIMLIGHT_CHECK(!directions.empty());
  RIMLIGHT_CHECK(size >= 1 && size <= cube::kLargestSize);
  RIMLIGHT_CHECK(std::has_single_bit(static_cast<unsigned>(size)));
  const auto first = find_coincident(directions);
  std::vector<Vec3d> distinct;
  std::vector<std::uint32_t> number(directions.size());  // among the distinct
  for (std::size_t i = 0; i < directions.size(); ++i) {
    if (first[i] != i) continue;
    number[i] = static_cast<std::uint32_t>(distinct.size());
    distinct.push_back(directions[i]);
  }
  std::vector<double> times(distinct.size());
  for (const std::uint32_t one : first) ++times[number[one]];

  auto parts = cut_all(distinct, std::countr_zero(static_cast<unsigned>(size)), cap);
  std::sort(parts.begin(), parts.end(), [](const CellPart& a, const CellPart& b) {
    return a.direction != b.direction ? a.direction < b.direction : a.texel < b.texel;
  });
  std::vector<std::size_t> begin(distinct.size() + 1, parts.size());
  for (std::size_t i = parts.size(); i-- > 0;) begin[parts[i].direction] = i;
  for (std::size_t i = distinct.size(); i-- > 0;) begin[i] = std::min(begin[i], begin[i + 1]);

  first_share_.push_back(0);
  for (const std::uint32_t one : first) {
    const std::uint32_t cell = number[one];
    for (std::size_t i = begin[cell]; i < begin[cell + 1]; ++i) {
      shares_.push_back({parts[i].texel, parts[i].solid_angle / times[cell]});
    }
    first_share_.push_back(shares_.size());
  }
}

double DirectionCells::solid_angle(std::size_t direction) const {
  double sum = 0;
  for (const Share& share : shares(direction)) sum += share.solid_angle;
  return sum;
}

}  // namespace rimlight
