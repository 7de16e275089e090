#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace rimlight {

/// Daubechies' wavelets with 4 taps and 2 vanishing moments on an interval of `size` samples, all
/// levels down to two scaling coefficients: an orthonormal transform of ℝ^size for which constant
/// and linear *samples* have no details at all, at the ends too (a periodised transform would wrap
/// one end around to the other).
///
/// Inside, the filters are Daubechies' (1988). At each end two low and two high filters of at most
/// 5 taps replace those that would reach beyond, laid out as in Cohen, Daubechies and Vial (1993),
/// "Wavelets on the interval and fast wavelet transforms". Theirs are the same at all levels and
/// keep the polynomials of a continuous function, for which samples must be prefiltered, which is
/// not orthogonal. Ours are derived level by level from what that level makes of constant and
/// linear samples, and so need no prefilter.
///
/// Order of coefficients: by band, so that a band is one range. Band b holds 2^(b+1) wavelets, each
/// about size / 2^(b+1) samples apart, finest last; band 0 holds the two scaling coefficients too:
///
///     band 0:    0 constant (mean · √size), 1 linear (rising), 2 … 3 the coarsest wavelets
///     band b>0:  2^(b+1) + position
class DaubechiesInterval {
 public:
  static constexpr std::size_t kSmallest = 4, kLargest = std::size_t{1} << 20;
  /// Taps of a boundary filter.
  static constexpr std::size_t kBoundaryTaps = 5;

  /// `size` samples: a power of two from kSmallest to kLargest, else CheckFailure.
  explicit DaubechiesInterval(std::size_t size);

  std::size_t size() const { return size_; }
  int band_count() const { return band_count_; }
  /// The first coefficient of a band; band_begin(band_count()) is the number of all.
  std::size_t band_begin(int band) const { return band == 0 ? 0 : std::size_t{2} << band; }
  int band_of(std::size_t coefficient) const;
  /// Samples from one wavelet of a band to the next.
  std::size_t band_step(int band) const { return size_ >> (band + 1); }

  /// Samples to coefficients for `lanes` independent signals at once, value by value:
  ///   samples       [size][lanes], overwritten as scratch
  ///   coefficients  [size][lanes], may not alias samples
  /// Error: each output is a sum of at most 5·log2(size) rounded operations.
  void forward(std::span<float> samples, std::span<float> coefficients,
               std::size_t lanes = 1) const;
  void forward(std::span<double> samples, std::span<double> coefficients,
               std::size_t lanes = 1) const;

  /// Coefficients to samples; the inverse and the transpose of forward().
  void inverse(std::span<const float> coefficients, std::span<float> samples,
               std::size_t lanes = 1) const;
  void inverse(std::span<const double> coefficients, std::span<double> samples,
               std::size_t lanes = 1) const;

  /// Four filters at one end of a level: two low (scaling) ones, then two high ones.
  using EndFilters = std::array<std::array<double, kBoundaryTaps>, 4>;
  /// One step, from `length` values to length / 2 of each kind. The left filters' taps are values
  /// 0 … 4, the right ones' length − 5 … length − 1; a level of 8 uses the outer four, and one of 4
  /// has only left ones.
  struct Level {
    std::size_t length = 0;
    EndFilters left{}, right{};
  };

 private:
  std::size_t size_;
  int band_count_;
  std::vector<Level> levels_;  // finest first
};

}  // namespace rimlight
