#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/math/vec.h"
#include "core/transport/vertex_transport.h"
#include "core/vertices/lobe_product_kernel.h"

namespace rimlight {

/// The product of functions of degree n, each with a lobe of degree n about an axis of its own, to
/// degree 2n, where it ends: T = O · g, of which ∫ L O g = Σ_k L_k T_k for any light L.
///
/// In the frame where the axis is z the lobe is zonal and mixes no m, so that the product is one
/// small matrix an m. Into that frame and back a function goes by R = X⁻¹ Z(−θ) X Z(−φ), with X the
/// quarter turn about x, whose bands are constant and three quarters zero. That takes O(n³)
/// operations, 12 times fewer at degree 10 than both M · O and the general product of two functions
/// would … for every vertex anew. Const and immutable: any thread. fp32: within 3e-6 of ‖O‖ · max
/// |g|.
class LobeProduct {
 public:
  /// 0 ≤ degree ≤ sh::kLargestDegree, else CheckFailure.
  explicit LobeProduct(int degree);

  /// What a lobe does in its own frame. `factors` [degree + 1]: √(4π/(2l + 1)) f_l0, what
  /// convolution with it multiplies band l by.
  class Lobe {
   public:
    Lobe(int degree, std::span<const float> factors);
    ZonalBand band(int l) const;

   private:
    int degree_;
    AlignedVector<float> factors_;
    std::vector<std::size_t> first_;  // [2 degree + 1]
  };

  struct Workspace {
    AlignedVector<float> values;
  };

  /// functions [(degree + 1)²][kBatchVertices], products [(2 degree + 1)²][kBatchVertices]; axes
  /// [kBatchVertices], of any length but zero. Allocates only the workspace's first growth.
  void multiply(const Lobe& lobe, std::span<const Vec3f> axes, std::span<const float> functions,
                std::span<float> products, Workspace& workspace) const;

  int degree() const { return degree_; }

 private:
  struct AxisAngles;
  struct Scratch;
  void turn_to_lobes(const AxisAngles& axis, const float* functions, const Scratch& scratch) const;
  void multiply_and_turn_back(const Lobe& lobe, const AxisAngles& axis, const Scratch& scratch,
                              float* products) const;

  int degree_;
  std::vector<SparseRows> quarter_, quarter_back_;  // [2 degree + 1], X and X⁻¹
};

}  // namespace rimlight
