#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/basis/sh_tripling.h"

namespace rimlight {

struct ShGridTransform;

/// Product projection: the coefficients h_i = ∫ f g Y_i dω of the product of two functions that are
/// given by spherical harmonics, cut off at a degree:
///
///     h_i = Σ_j Σ_k C(i, j, k) f_j g_k        (Sloan 2008; Lee 2014, eq. 2.2)
///
/// It is not summed up like this: f and g are taken to a grid on which Gauss–Legendre latitudes and
/// equal azimuths integrate exactly to the degrees' sum, multiplied there, and taken back. The
/// result is the same but for rounding, since all are polynomials; O(n³) replaces O(n⁵), already at
/// degree 9 a third of the operations, and all are small dense matrices times many receivers.
/// Const and immutable: any thread. Convention: sh_tripling.h.
class ShProduct {
 public:
  /// Each 0 … sh::kLargestLightDegree, else CheckFailure.
  struct Degrees {
    int first, second, product;
  };
  explicit ShProduct(const Degrees& degrees);
  ~ShProduct();
  ShProduct(ShProduct&&) noexcept;
  ShProduct& operator=(ShProduct&&) noexcept;

  /// Receivers come in whole vectors of the widest target.
  static constexpr std::size_t kLaneMultiple = 16;

  /// What the kernel writes on its way; one thread at a time. Grows at its first use for a product.
  struct Workspace {
    AlignedVector<float> values;
  };

  /// Many products at once, receiver by receiver:
  ///   first    [(first degree + 1)²][lanes]      second  [(second degree + 1)²][lanes]
  ///   product  [(product degree + 1)²][lanes], overwritten; may be first or second
  /// `lanes` is a multiple of kLaneMultiple and the sizes fit, else CheckFailure. fp32; relative to
  /// ‖f‖ ‖g‖ the error is below 1e-7 at degree 10 (test). The same bits for the same binary and
  /// target whatever other lanes hold. Allocates nothing but the workspace's first growth.
  void multiply(std::span<const float> first, std::span<const float> second,
                std::span<float> product, std::size_t lanes, Workspace& workspace) const;

  /// One pair. Allocates.
  std::vector<float> multiply(std::span<const float> first, std::span<const float> second) const;

  const Degrees& degrees() const { return degrees_; }
  /// Additions and multiplications of one product as it is done here.
  double flops() const;

 private:
  struct Plan;
  Degrees degrees_;
  std::unique_ptr<const Plan> plan_;
};

/// The SIMD target in use.
const char* sh_product_target();

}  // namespace rimlight
