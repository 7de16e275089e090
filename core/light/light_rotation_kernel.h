#pragma once

#include <cstdint>
#include <span>

#include "core/math/vec.h"

namespace rimlight {

/// The kernels of LightRotator. All lengths are in cells: texels of the target face, whose plane
/// spans [0, size]² with x = 2u/size − 1.

/// Quadrilaterals that go through the overlap kernel together; a multiple of every target's lanes.
inline constexpr std::size_t kOverlapLanes = 16;

/// The largest side of a box of cells; larger ones are cut up.
inline constexpr int kLargestOverlapSide = 5;

/// Rotated source texels as seen in a target face's plane, with boxes of cells of one shape.
struct OverlapBatch {
  int columns = 0;  // of each box
  int rows = 0;
  std::size_t count = 0;  // quadrilaterals in use, up to kOverlapLanes
  /// Corners, counter-clockwise, in cells from the box's low corner. What of the quadrilateral lies
  /// outside the box is cut off.
  alignas(64) float u[4][kOverlapLanes] = {};
  float v[4][kOverlapLanes] = {};
  float box_u[kOverlapLanes] = {};  // the box's low corner on the face
  float box_v[kOverlapLanes] = {};
  std::uint32_t first_texel[kOverlapLanes] = {};  // the target texel at the box's low corner
  alignas(16) float radiance[kOverlapLanes][4] = {};
};

/// energy[texel] += radiance · (solid angle that the quadrilateral and the texel share), for every
/// quadrilateral of the batch and texel of its box.
///   size    of the target, at least 8
///   energy  [6·size²][4] (red, green, blue, unused), 16-byte aligned
///
/// The solid angle is ∫ρ over quadrilateral ∩ cell, ρ = (1 + x² + y²)^(−3/2). ρ is expanded to
/// second order about the *cell's* middle, so that quadrilaterals which tile a cell give the same
/// sum however they tile it (a uniform light stays uniform); a cell is small, so that each source
/// keeps its energy to (1/size)³. By Green's theorem the integral is Σ over edges of ∫ P(u, v) dv
/// with P = ∫ρ du, a polynomial of degree 3 along an edge: two Gauss–Legendre points are exact.
void add_overlaps(const OverlapBatch& batch, int size, std::span<float> energy) noexcept;

/// A row of a source face's texel corners, rotated: corner i has direction origin + i · step.
struct CornerRow {
  Vec3f origin;
  Vec3f step;
};

/// Where each direction of a row meets the cube: face and place in its plane, in cells.
/// The spans have the same size, a multiple of kOverlapLanes, and are 64-byte aligned.
void project_corners(const CornerRow& row, int size, std::span<float> u, std::span<float> v,
                     std::span<std::int32_t> face) noexcept;

}  // namespace rimlight
