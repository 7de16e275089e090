#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/basis/cube_map.h"

namespace rimlight {

/// The orthonormal two-dimensional Haar basis on each face of a cube map, all levels down to one
/// scaling coefficient a face (Ng, Ramamoorthi and Hanrahan 2003 use the same, non-standard, form).
///
/// Solid angle, the one convention: a *light's* texel value is its mean radiance over the texel's
/// solid angle, and a *transport's* texel value is the integral of its transport over the texel,
/// the solid angle included. Both are transformed by the same plain orthonormal transform H, so
///
///     Σ_j (H L)_j (H M)_j = Σ_t L_t M_t = Σ_t (mean of L over t) · ∫_t M dω
///
/// is the integral of light times transport over the sphere, up to what both vary together inside a
/// texel. A uniform light is one coefficient a face. Σ L² over coefficients is not ∫ L² dω: texels
/// differ in solid angle.
///
/// Order of coefficients: by band, so that a band is one range of columns. Band b holds the
/// wavelets of 2^b × 2^b a face, finest last; band 0 holds the scaling coefficients too (Overbeck
/// 2006, §6.1):
///
///     band 0:    face · 4 + {0 scaling, 1 across x, 2 across y, 3 diagonal}
///     band b>0:  6·4^b + ((face · 3 + kind) · 2^b + row) · 2^b + column, kind as above less 1
class CubeHaar {
 public:
  /// `size` texels a side: a power of two from 2 to cube::kLargestSize, else CheckFailure.
  explicit CubeHaar(int size);

  int size() const { return size_; }
  std::size_t coefficient_count() const { return cube::texel_count(size_); }
  int band_count() const { return band_count_; }
  /// The first coefficient of a band; band_begin(band_count()) is the number of all.
  std::size_t band_begin(int band) const {
    return band == 0 ? 0 : std::size_t{cube::kFaces} << (2 * band);
  }
  int band_of(std::size_t coefficient) const;
  /// Texels under a band's wavelets: 4^(levels − band), the paper's area weight.
  double band_area(int band) const {
    return static_cast<double>(std::size_t{1} << (2 * (band_count_ - band)));
  }

  /// Texels to coefficients for `lanes` independent signals at once, value by value:
  ///   texels        [coefficient_count][lanes], overwritten as scratch
  ///   coefficients  [coefficient_count][lanes], may not alias texels
  /// Error: each output is a sum of at most 4·log2(size) rounded operations.
  void forward(std::span<float> texels, std::span<float> coefficients, std::size_t lanes = 1) const;

  /// Coefficients to texels; the inverse and the transpose of forward().
  void inverse(std::span<const float> coefficients, std::span<float> texels,
               std::size_t lanes = 1) const;

 private:
  int size_;
  int band_count_;
};

}  // namespace rimlight
