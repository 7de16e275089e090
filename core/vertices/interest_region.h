#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/vertices/vertex_graph.h"
#include "core/vertices/vertex_selection.h"

namespace rimlight {

/// One kind of light (diffuse, or highlights) at the packed vertices of a selection, [panel][3]
/// [kBatchVertices]: what it is to its base degree, and as far as it has been calculated.
struct FilteredLight {
  std::span<const float> base;
  std::span<float> light;
};

/// The region of interest of one kind of light: the vertices whose light the higher degrees change.
/// What filtering has found is grown over the surface, and what is outside is smoothed towards it
/// (Lee 2014, §5.2). Reused from frame to frame. One thread at a time.
class InterestRegion {
 public:
  /// Starts anew, with no vertex inside.
  void reset(const VertexSelection& selection);
  void add(std::size_t packed) { inside_[packed] = 1; }
  bool contains(std::size_t packed) const { return inside_[packed] != 0; }

  /// Calculates the light of a selection in full, [panel][3][kBatchVertices].
  using Calculate = std::function<void(const VertexSelection&, std::span<float>)>;

  /// Breadth first: calculates in full the neighbours of the region that are selected and outside,
  /// each once; those whose light differs from its base by at least `threshold` in some channel
  /// join with their full light, and their neighbours follow.
  void refine(const VertexGraph& graph, float threshold, const Calculate& calculate,
              const FilteredLight& filtered);

  /// The difference from the base at the first tier of vertices outside goes two thirds of the way
  /// to the mean of its neighbours inside, that at the second tier one third of the way to the mean
  /// of its neighbours in the first: linearly to nothing at a third tier.
  void smooth(const VertexGraph& graph, const FilteredLight& filtered);

  /// The share of the selected vertices that are outside.
  double outside() const;

 private:
  /// Selected vertices that are outside, not in a tier or tested yet, and next to `from`: rising,
  /// as packed lanes. Marks them.
  void find_next(const VertexGraph& graph, std::span<const std::uint32_t> from,
                 std::vector<std::uint32_t>& next);
  void blend_tier(const VertexGraph& graph, std::span<const std::uint32_t> tier,
                  std::uint8_t source, const FilteredLight& filtered);

  std::vector<std::uint32_t> vertices_;  // [packed]
  std::vector<std::int32_t> packed_;     // [vertex], −1 where not selected
  std::vector<std::uint8_t> inside_;     // [packed]
  std::vector<std::uint8_t> mark_;       // [packed]: tested, or the tier
  std::vector<std::uint32_t> frontier_, next_, chosen_;
  VertexSelection selection_;
  AlignedVector<float> calculated_, blended_;
};

}  // namespace rimlight
