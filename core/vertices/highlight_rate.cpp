#include "core/vertices/highlight_rate.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/base/parallel.h"
#include "core/transport/receivers.h"

namespace rimlight {
namespace {

/// Mirrored directions this far apart (radians), times the degree and one, are like: at degree 10
/// 31°, normals 16° apart. On a mesh with a vertex for every pixel or two, a third of that leaves
/// half of the pixels without a neighbour: a third of the error, and a frame no faster.
constexpr double kLikeAngle = 6.0;
/// How much depth may change along a surface: as at 83° from facing the eye.
constexpr double kSteepest = 8;

PixelLayout layout_of(const VertexView& view) { return {view.width(), view.height()}; }

}  // namespace

std::array<GridWeight, 4> grid_weights(int x, int y, int spacing, GridCorners fitting) {
  const int left = x - x % spacing, top = y - y % spacing;
  const float u = static_cast<float>(x - left) / static_cast<float>(spacing);
  const float v = static_cast<float>(y - top) / static_cast<float>(spacing);
  std::array<GridWeight, 4> result{{{left, top, (1 - u) * (1 - v)},
                                    {left + spacing, top, u * (1 - v)},
                                    {left, top + spacing, (1 - u) * v},
                                    {left + spacing, top + spacing, u * v}}};
  float sum = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if ((fitting >> i & 1) == 0) result[i].weight = 0;
    sum += result[i].weight;
  }
  for (GridWeight& one : result) one.weight /= sum;
  return result;
}

HighlightPlan::HighlightPlan(const VertexMesh& mesh, int degree)
    : mesh_(mesh),
      least_cosine_(static_cast<float>(std::cos(std::min(1.0, kLikeAngle / (degree + 1))))),
      needed_(mesh.positions.size()) {
  for (auto& vertices : vertices_) vertices.reserve(mesh.positions.size());
}

bool HighlightPlan::is_sample(int x, int y) {
  // Multiplies and xors that mix all bits of a place (MurmurHash3's finalizer).
  auto hash = static_cast<std::uint32_t>(x) * 0x9e3779b1u + static_cast<std::uint32_t>(y);
  hash = (hash ^ hash >> 16) * 0x85ebca6bu;
  hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
  return (hash ^ hash >> 16) % kSampleShare == 0;
}

std::size_t HighlightPlan::evaluated(HighlightRate rate) const {
  std::size_t sum = 0;
  for (const Counts& counts : of_tiles_) sum += counts[index_of(rate)];
  return sum;
}

void HighlightPlan::find(const VertexView& view) {
  width_ = view.width();
  const PixelLayout layout = layout_of(view);
  corners_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(view.height()));
  of_tiles_.resize(layout.tile_count());
  std::ranges::fill(needed_, std::uint8_t{0});
  parallel_for(of_tiles_.size(),
               [&](std::size_t tile) { find_tile(view, tile, view.depth_of_pixel()); });
  for (auto& vertices : vertices_) vertices.clear();
  for (const std::uint32_t vertex : view.highlight_vertices()) {
    for (std::size_t rate = 0; rate < kHighlightRates; ++rate) {
      if (rate == 0 || needed_[vertex] > rate) vertices_[rate].push_back(vertex);
    }
  }
}

void HighlightPlan::find_tile(const VertexView& view, std::size_t tile, double depth_of_pixel) {
  constexpr int kSide = PixelLayout::kTileSide;
  const auto [left, top] = layout_of(view).pixel(tile * kTileReceivers);
  Counts counts{};
  for (int y = top; y < std::min(top + kSide, view.height()); y += view.step()) {
    for (int x = left; x < std::min(left + kSide, view.width()); x += view.step()) {
      read_pixel(view, x, y, depth_of_pixel, counts);
    }
  }
  of_tiles_[tile] = counts;
}

void HighlightPlan::read_pixel(const VertexView& view, int x, int y, double depth_of_pixel,
                               Counts& counts) {
  corners_[index(x, y)] = 0;
  if (!view.has_highlight(0, x, y)) return;
  ++counts[0];
  HighlightRate coarsest = HighlightRate::every;
  for (const HighlightRate rate : {HighlightRate::quarter, HighlightRate::sixteenth}) {
    const int side = spacing(rate);
    const bool is_on_grid = side <= view.step() || (x % side == 0 && y % side == 0);
    const GridCorners like =
        is_on_grid ? GridCorners{0} : fitting(view, x, y, side, kSteepest * side * depth_of_pixel);
    corners_[index(x, y)] |=
        static_cast<std::uint8_t>(rate == HighlightRate::quarter ? like : like << 4);
    if (like != 0 && !is_sample(x, y)) continue;
    ++counts[index_of(rate)];
    coarsest = rate;
  }
  if (coarsest != HighlightRate::every) need(view, x, y, coarsest);
}

GridCorners HighlightPlan::fitting(const VertexView& view, int x, int y, int spacing,
                                   double most_depth) const {
  const auto& corners = mesh_.triangles[view.hit(0, x, y).triangle];
  const Vec3f& mirrored = view.mirrored(0, x, y);
  const float distance = view.distance(0, x, y);
  GridCorners result = 0;
  const int left = x - x % spacing, top = y - y % spacing;
  for (int i = 0; i < 4; ++i) {
    const int at_x = left + i % 2 * spacing, at_y = top + i / 2 * spacing;
    // A corner beyond the one that the pixel is in line with has no weight.
    if ((i % 2 == 1 && x == left) || (i / 2 == 1 && y == top)) continue;
    if (at_x >= view.width() || at_y >= view.height() || !view.has_highlight(0, at_x, at_y)) {
      continue;
    }
    const auto& others = mesh_.triangles[view.hit(0, at_x, at_y).triangle];
    const bool is_like = mesh_.materials[corners[0]] == mesh_.materials[others[0]] &&
                         dot(mirrored, view.mirrored(0, at_x, at_y)) >= least_cosine_ &&
                         std::abs(view.distance(0, at_x, at_y) - distance) <= most_depth * distance;
    if (is_like) result = static_cast<GridCorners>(result | 1 << i);
  }
  return result;
}

void HighlightPlan::need(const VertexView& view, int x, int y, HighlightRate coarsest) {
  const auto wanted = static_cast<std::uint8_t>(1 + index_of(coarsest));
  for (const std::uint32_t corner : mesh_.triangles[view.hit(0, x, y).triangle]) {
    const std::atomic_ref known(needed_[corner]);
    std::uint8_t before = known.load(std::memory_order_relaxed);
    while (before < wanted &&
           !known.compare_exchange_weak(before, wanted, std::memory_order_relaxed)) {
    }
  }
}

}  // namespace rimlight
