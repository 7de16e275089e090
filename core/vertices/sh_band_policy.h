#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rimlight {

/// Which coefficients of a light a frame brings up to date, of those to a degree n: per-band
/// incremental spherical harmonics (Overbeck 2006, chapter 8).
///
/// Bands are filled from the lowest on: the largest residuals of a band, until what is left of the
/// band is below a tolerance; then the next band; and when all are, the tolerance falls to a tenth,
/// and the lowest is next again. So no band is worse than under a low-degree light of as many
/// coefficients, and updates do not jump between bands from frame to frame, which would flicker.
/// Figure 8.1 never takes what it chose off the band's error, and so would never leave the first
/// band; here it does. Its error is that of the light: Σ |target − held| over a band's coefficients
/// and channels, relative to Σ |target| of all.
///
/// Allocates nothing after its first choice. One thread at a time; the same choice for the same
/// residual.
class ShBandPolicy {
 public:
  /// 0 … sh::kLargestLightDegree, else CheckFailure. The tolerance starts from `tolerance`, 5·10⁻⁴
  /// in the paper.
  explicit ShBandPolicy(int degree, double tolerance = 5e-4);

  /// At most `budget` coefficients, in rising order, each with a residual that is not zero. target
  /// and held: [3][(n + 1)²], else CheckFailure. Valid until the next call.
  std::span<const std::uint32_t> choose(std::span<const float> target, std::span<const float> held,
                                        std::size_t budget);

  int degree() const { return degree_; }

 private:
  /// One band's coefficients by falling residual, and how many of them are chosen.
  struct Band {
    std::size_t begin = 0, end = 0, next = 0;
    double error = 0;  // of what is not chosen
  };
  void rank(std::span<const float> target, std::span<const float> held);
  bool take(Band& band, double least);

  int degree_;
  double tolerance_;
  std::vector<Band> bands_;
  std::vector<std::uint32_t> ranked_;  // band by band
  std::vector<double> residual_;       // [coefficient]
  std::vector<std::uint32_t> chosen_;
};

}  // namespace rimlight
