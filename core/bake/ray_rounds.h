#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/math/sampling.h"

namespace rimlight {

// How many rays a vertex gets. Its rays cover the unit square in a *round*: a grid of 2s × 2s
// cells, a point in each. Every four cells that make one of the s × s larger cells are dealt at
// random to four *replicates*, so that each is by itself a stratified sample of s × s points, and
// their mean the estimate. What the replicates differ by estimates the mean's error; as cells of
// one replicate avoid those of the others, it is too large rather than too small (by up to 2; right
// where occluders are smaller than cells).

inline constexpr std::size_t kReplicates = 4;

struct RaySettings {
  int degree = 10;
  double error = 0.01;   // rms over a vertex' coefficients
  int most_rays = 4096;  // a vertex
  std::uint64_t seed = 1;
};

/// The points of a round, replicate by replicate: [kReplicates][s²].
std::vector<Sample2> round_points(int s, Random& random);

/// s of the first round: enough that an occluder which a single ray finds weighs no more than the
/// error asked for.
int first_round(const RaySettings& settings);
/// s of the round after one of `s` that had this error; 0 when that was good enough, or the cap is
/// reached.
int next_round(const RaySettings& settings, int s, double error);

/// Mean and error of replicates.
class ReplicateMean {
 public:
  /// `coefficients`: of each replicate.
  explicit ReplicateMean(std::size_t coefficients) : sums_(kReplicates * coefficients) {}

  std::span<double> replicate(std::size_t r) {
    return std::span(sums_).subspan(r * coefficients(), coefficients());
  }
  void clear() { sums_.assign(sums_.size(), 0); }
  double mean(std::size_t i) const;
  /// Root mean square over the coefficients of the standard error of the mean.
  double error() const;
  /// The square of the standard error of one coefficient's mean.
  double error_squared(std::size_t i) const;

 private:
  std::size_t coefficients() const { return sums_.size() / kReplicates; }

  std::vector<double> sums_;
};

}  // namespace rimlight
