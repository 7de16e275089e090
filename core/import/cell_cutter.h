#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/import/direction_cells.h"
#include "core/import/face_polygon.h"

namespace rimlight {

/// A part of one cell in one texel.
struct CellPart {
  std::uint32_t direction;
  std::uint32_t texel;
  double solid_angle;
};

/// Cuts squares of a cube map into the cells of distinct directions; see DirectionCells. One thread
/// at a time.
class CellCutter {
 public:
  /// A square of a face that is cut into 2^level × 2^level.
  struct Square {
    int face = 0;
    int level = 0;
    std::uint32_t column = 0, row = 0;
  };

  /// `directions` must outlive it. `texel_level`: log2 of the cube map's size.
  CellCutter(std::span<const Vec3d> directions, int texel_level, const SphericalCap& cap);

  /// All parts of all texels of a square (of at least a texel), texel by texel, in each by
  /// direction.
  std::vector<CellPart> cut(const Square& square);

 private:
  enum class Place { inside, across, outside };

  struct Bounds {
    double x, y, side;  // low corner
    Vec3d middle;       // unit
    double radius;      // the largest distance from the middle to a point of the square
  };

  Bounds bounds(const Square& square) const;
  Place place_in_cap(const Bounds& bounds) const;
  void visit(const Square& square, const std::vector<std::uint32_t>& above);
  std::uint32_t nearest(const Vec3d& point, const std::vector<std::uint32_t>& candidates) const;
  void keep_possible(const Bounds& bounds, const std::vector<std::uint32_t>& above,
                     std::vector<std::uint32_t>& kept) const;
  bool is_leaf(const Square& square, std::size_t candidates, Place place) const;
  void cut_leaf(const Square& square, const Bounds& bounds, Place place,
                const std::vector<std::uint32_t>& candidates);
  void finish_texel(std::size_t first_part);

  std::span<const Vec3d> directions_;
  int texel_level_;
  SphericalCap cap_;
  double cap_cosine_;
  int rim_level_;  // squares that the rim crosses are halved to here
  std::vector<std::vector<std::uint32_t>> candidates_;  // [level]
  FacePolygon polygon_;
  std::vector<CellPart> parts_;
};

}  // namespace rimlight
