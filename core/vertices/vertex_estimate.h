#pragma once

#include <span>
#include <vector>

#include "core/vertices/bake_error.h"
#include "core/vertices/vertex_materials.h"
#include "core/vertices/view_weights.h"

namespace rimlight {

/// Estimates how far pictures of a bake of vertices are from one without the bake's own errors:
/// those of sampling, and what was left out.
///
/// A vertex' irradiance is Σ L_i t_i, and errors e_i of t know nothing of where the light comes
/// from. Over all turns of the light
///
///   E (Σ L_i e_i)² = Σ_l P_l s_l,   P_l = Σ_m L_lm²,   s_l: mean square of e in band l
///
/// A highlight is the product of light, visibility and lobe h at one direction. An error e_i of
/// visibility, i of band k, adds e_i times a coefficient of h · L, and over all turns of L against
/// h
///
///   E (Σ e_i (h·L)_i)² = Σ_k s_k Σ_{a,b} H_a P_b (2k + 1)/4π (a b k; 0 0 0)²,  H_a = h_a0²
///
/// with the square of a 3j symbol. Errors of irradiance and visibility are taken not to know of
/// each other. What one turn of the light makes differs from the mean over all: by a few tenths.
///
/// Immutable after it is made; any thread.
class VertexEstimator {
 public:
  explicit VertexEstimator(const VertexScene& scene);

  /// Whether the bake says anything of its error.
  bool is_known() const { return error_.is_known; }
  /// [vertex], for ViewWeights.
  std::span<const float> sampling() const { return sampling_; }
  /// The expected square of the picture's error, summed over pixels and channels.
  ///   light  [3][(K + 1)²], at most of kLargestLightDegree
  double square(const ViewWeights& weights, const VertexMaterials& materials,
                std::span<const float> light) const;

 private:
  /// [lobe band][light band]
  using Table = std::vector<double>;

  Table table_of(const std::vector<double>& squares, int first, int last) const;
  double of_table(const Table& table, const float* lobe, std::span<const double> powers) const;

  VertexBakeError error_;
  std::vector<float> sampling_;
  int irradiance_degree_, visibility_degree_;
  std::size_t material_count_;
  Table by_chance_, left_out_;  // of highlights
};

/// (a b c; 0 0 0)², the square of a Wigner 3j symbol.
double three_j_squared(int a, int b, int c);

}  // namespace rimlight
