#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/basis/cube_map.h"

namespace rimlight {

/// How the energy of one direction is shared out among texels: weights ≥ 0 that sum to 1.
struct SplatShares {
  std::array<std::uint32_t, 4> texel{};
  std::array<float, 4> weight{};
};

/// Shares a direction out among the texels whose middles surround it, so that the shares' mean
/// direction is the direction itself and the shares are continuous over the whole sphere. The
/// middles of the texels, joined up, cut the sphere into
///
///   quadrilaterals inside a face   bilinear in the face's plane
///   quadrilaterals across an edge  bilinear in the plane perpendicular to the edge's middle
///                                  direction, where the four middles form a rectangle
///   triangles at the cube's vertices, where three texels meet: barycentric
///
/// and neighbouring pieces agree on the lines between them.
class CubeSplat {
 public:
  /// `size` at least 2.
  explicit CubeSplat(int size);

  SplatShares shares(const cube::FacePoint& point) const;

 private:
  /// A place between texel middles along one axis: index `low`, and the share of the next.
  struct Between {
    int low = 0;
    double next_share = 0;
  };
  Between between(double x) const;
  std::uint32_t texel(int face, int row, int column) const;
  std::uint32_t beyond(int face, cube::Border border, int index) const;
  /// `across` of the place is beyond the last middle at `border`; `along` already seen in the
  /// edge's plane.
  SplatShares across_edge(int face, cube::Border border, double across, double along) const;
  SplatShares at_vertex(const cube::FacePoint& point) const;

  int size_;
  double last_;                        // the last middle's coordinate: 1 − 1/size
  std::vector<std::uint32_t> beyond_;  // [face][border][index]
};

}  // namespace rimlight
