#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace rimlight::test {

/// The standard score of a χ² of `bins` equally likely bins: (χ² − k) / √(2k) with k = bins − 1,
/// near normal for a hundred bins or more. |score| > 6 has a chance below 1e-8 for a right sampler.
inline double uniformity_score(const std::vector<std::size_t>& bins) {
  double total = 0;
  for (const std::size_t count : bins) total += static_cast<double>(count);
  const double expected = total / static_cast<double>(bins.size());
  double chi2 = 0;
  for (const std::size_t count : bins) {
    const double difference = static_cast<double>(count) - expected;
    chi2 += difference * difference / expected;
  }
  const double freedom = static_cast<double>(bins.size()) - 1;
  return (chi2 - freedom) / std::sqrt(2 * freedom);
}

/// Counts values of [0, 1) in equal bins; values outside fall into the nearest.
class Histogram {
 public:
  explicit Histogram(std::size_t bins) : bins_(bins) {}
  void add(double value) {
    const double place = std::floor(value * static_cast<double>(bins_.size()));
    const double last = static_cast<double>(bins_.size() - 1);
    ++bins_[static_cast<std::size_t>(std::fmin(std::fmax(place, 0), last))];
  }
  double score() const { return uniformity_score(bins_); }

 private:
  std::vector<std::size_t> bins_;
};

/// The mean of many values and how far it may be from the true one.
class Mean {
 public:
  void add(double value) {
    ++count_;
    sum_ += value;
    squares_ += value * value;
  }
  double value() const { return sum_ / count_; }
  /// (mean − expected) in standard errors: |score| > 6 has a chance of 2e-9.
  double score(double expected) const {
    const double variance = squares_ / count_ - value() * value();
    return (value() - expected) / std::sqrt(variance / count_);
  }

 private:
  double count_ = 0;
  double sum_ = 0;
  double squares_ = 0;
};

}  // namespace rimlight::test
