#pragma once

#include <cstddef>

#include "core/relight/tile_image.h"
#include "core/vertices/highlight_rate.h"
#include "core/vertices/vertex_shading.h"

namespace rimlight {

/// What interpolating highlights did to a frame, measured where samples were evaluated as well.
struct MeasuredError {
  std::size_t interpolated = 0, samples = 0;  // pixels
  double square = 0;                          // Σ over samples and channels of the difference's

  MeasuredError& operator+=(const MeasuredError& other);
  /// Of all interpolated pixels, estimated: Σ over them and channels.
  double square_of_all() const;
};

/// As shade_tile() of a view of one layer, but highlights are evaluated at a coarser rate only, and
/// interpolated between, by the plan of this view; the rest of the light has the same bits. The
/// light of plan.vertices(rate) is known. Any thread; allocates nothing after each thread's first
/// tile.
double shade_tile(const VertexShading& shading, const HighlightPlan& plan, HighlightRate rate,
                  int left, int top, TileImage& image, MeasuredError& error);

}  // namespace rimlight
