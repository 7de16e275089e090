#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/vertices/vertex_view.h"

namespace rimlight {

/// How the errors of vertices add up to those of a view's pixels, material by material: sums over
/// pixels of squares. A pixel is the mean of its points, each interpolated over three corners;
/// errors by chance are each vertex' own, so that of weights w the pixel has Σ w² of their square
/// (times what that vertex has of the mean); those that neighbours share it has whole, (Σ w)².
struct MaterialWeights {
  Vec3d matt_by_chance;  // Σ over pixels of Σ (w · tint)², by channel; vertices without highlight
  Vec3d glossy_by_chance;          // the same of those with one
  Vec3d shared;                    // (Σ w · tint)², of both
  double highlight_by_chance = 0;  // of highlights, without tints
  double highlight_shared = 0;

  MaterialWeights& operator+=(const MaterialWeights& other);
};

/// They are summed over every fourth pixel both ways (of small pictures over all) and scaled up.
/// One thread at a time; computes on all cores; allocates nothing after the first view.
class ViewWeights {
 public:
  explicit ViewWeights(std::size_t materials) : sums_(materials) {}

  /// `sampling`: [vertex], sampling_weights().
  void find(const VertexView& view, const VertexMesh& mesh, std::size_t highlight_count,
            std::span<const float> sampling);
  const MaterialWeights& of(std::size_t material) const { return sums_[material]; }

 private:
  std::vector<MaterialWeights> sums_;  // [material]
  std::vector<MaterialWeights> rows_;  // [rows][material]
};

}  // namespace rimlight
