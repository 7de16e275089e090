#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/light/sun_and_sky.h"
#include "core/vertices/vertex_view.h"

namespace rimlight {

/// What a sun is to one point that a view shows.
struct SunAtPoint {
  float cosine = 0;   // max(0, n · s), n the unit interpolated normal
  float visible = 0;  // share of the sun's disc that the point sees; 0 where the cosine is
};

/// Which of the points that a view shows see the sun, by rays: as sharp as pixels, whatever the
/// mesh's or the harmonics' resolution. Kept while view and sun stand still. The same for the same
/// view and sun, whatever came before. One thread at a time; computes on all cores.
///
/// Rays start at the surface that the normals tell of rather than on the flat triangle (Hanika
/// 2021, "Hacking the shadow terminator": the point is moved to the mean of its projections on the
/// tangent planes at the corners, where it is below them), so that the border of a round thing's
/// own shade is as smooth as its normals.
class SunShadows {
 public:
  /// `rays`: to each point of the view, evenly over the sun's disc; 1 goes to its middle. The mesh
  /// must outlive it. CheckFailure when rays < 1.
  SunShadows(const VertexMesh& mesh, std::shared_ptr<const TriangleTree> tree, int rays);

  /// The sun as it stands now. Traces unless view and sun are those of before; `view_changed`: the
  /// view has looked elsewhere, or in more detail, since the last call.
  void find(const VertexView& view, const Sun& sun, bool view_changed);

  const SunAtPoint& at(std::size_t layer, std::size_t pixel) const { return layers_[layer][pixel]; }

 private:
  struct Tracer;

  const VertexMesh& mesh_;
  std::shared_ptr<const TriangleTree> tree_;
  int rays_;
  std::optional<Sun> sun_;                       // of the shadows that are known
  std::vector<std::vector<SunAtPoint>> layers_;  // [layer][height · width]
};

}  // namespace rimlight
