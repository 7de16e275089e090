#pragma once

#include <cstddef>
#include <span>

#include "core/base/aligned_vector.h"
#include "core/basis/sh_tripling.h"

namespace rimlight {

/// The degrees first … last, both included.
struct ShDegreeRange {
  int first = 0;
  int last = 0;
};

/// The product matrix of a light: what multiplication with it does to transport of degree n, cut
/// off at n again, for each colour channel (Lee 2014, eq. 2.2, there L̂):
///
///     M_ij = Σ_k C(i, j, k) L_k,       product_i = Σ_j M_ij transport_j
///
/// It sees the light to degree 2n, and is exact when it is given that: then M is the quadratic form
/// ∫ L f² dω, and no eigenvalue of a light without negative radiance is negative. (The thesis knows
/// its lights to degree n only. Cutting them there is an error that its tables have, and nothing to
/// do otherwise.) M is symmetric, and linear in the light.
/// Any thread may read; one at a time may change. Convention: sh_tripling.h.
class ShProductMatrix {
 public:
  static constexpr std::size_t kChannels = 3;
  static constexpr ShDegreeRange kAllDegrees = {0, sh::kLargestLightDegree};

  /// Of no light: zeros. Degrees 0 … sh::kLargestDegree, else CheckFailure. Makes the table of
  /// tripling coefficients when it is the first of its degree.
  explicit ShProductMatrix(int degree);

  /// The matrix of a light, planar: [kChannels][(K + 1)²], K 0 … sh::kLargestLightDegree, else
  /// CheckFailure. Of its coefficients those of `degrees` count, as far as 2n; {0, n} reproduces
  /// the thesis. fp32: each entry within 2⁻²⁴ · ‖L‖ of the exact one. Allocates nothing.
  void set_light(std::span<const float> light, const ShDegreeRange& degrees = kAllDegrees);

  /// Adds the matrix of a light to this one. With one degree of a light after another it adds the
  /// increments of that light's matrix, which end at set_light() but for rounding; with what a
  /// light changed by, it follows the change.
  void add_light(std::span<const float> light, const ShDegreeRange& degrees = kAllDegrees);

  int degree() const { return degree_; }
  /// Rows, and columns: (n + 1)².
  std::size_t size() const { return size_; }
  /// Row i of a channel, and by symmetry column i: [size()], 64-byte aligned; zeros up to stride().
  const float* row(std::size_t channel, std::size_t i) const {
    return values_.data() + (channel * size_ + i) * stride_;
  }
  std::size_t stride() const { return stride_; }

 private:
  enum class Build { from_zero, on_top };
  void build(std::span<const float> light, const ShDegreeRange& degrees, Build how);

  int degree_;
  std::size_t size_, stride_;
  const ShTripling* table_;
  AlignedVector<float> values_;  // [channel][i][stride]
  AlignedVector<float> packed_;  // the light, in the kernel's order
  AlignedVector<float> rows_;    // two rows on their way into values_
};

/// Adds to the products of many receivers' transport with a light what they gain when both, and the
/// result, grow from the degrees below `degrees` to degrees.last (Lee 2014, §5.1.2; its Algorithm 3
/// lists the same sums, but adds up whole R where only these belong):
///
///     product_i += Σ_j M_ij transport_j     over all j of degrees 0 … last, for i of `degrees`;
///                                           over the j of `degrees` only, for i below
///
/// Starting from zeros, the increments of any split of 0 … n add up to the whole M · transport,
/// which is also what {0, n} gives.
///   transport  [(n + 1)²][lanes]               product  [kChannels][(n + 1)²][lanes]
/// n is the matrix' degree; `lanes` a multiple of 16; 0 ≤ first ≤ last ≤ n, else CheckFailure. Best
/// with some 64 receivers, whose transport stays in the first-level cache. fp32; any thread.
void add_product_degrees(const ShProductMatrix& matrix, const ShDegreeRange& degrees,
                         std::span<const float> transport, std::span<float> product,
                         std::size_t lanes);

/// Multiplications and additions of add_product_degrees() for one receiver.
double product_degrees_flops(const ShDegreeRange& degrees);

}  // namespace rimlight
