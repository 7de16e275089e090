#include "core/relight/cost_model.h"

#include <algorithm>

namespace rimlight {

std::size_t CostModel::bytes_within(double milliseconds) const {
  constexpr double kMostBytes = 1e15;  // more than any transport has; fits an integer
  return static_cast<std::size_t>(
      std::clamp((milliseconds - kFixedMs) / per_byte_, 0.0, kMostBytes));
}

void CostModel::learn(std::size_t bytes, double milliseconds) {
  constexpr std::size_t kFewestBytes = 200'000;  // below, the fixed part hides the rest
  constexpr double kLeast = 1e-9, kMost = 1e-4;  // 1 TB/s, 10 MB/s
  constexpr double kShare = 0.3;
  constexpr double kMostAtOnce = 3;  // a frame that lost its core says nothing about the next
  constexpr double kHope = 0.9;
  if (bytes < kFewestBytes) {
    per_byte_ = std::max(kLeast, kHope * per_byte_);
    return;
  }
  const double measured = (milliseconds - kFixedMs) / static_cast<double>(bytes);
  per_byte_ += kShare * (std::min(measured, kMostAtOnce * per_byte_) - per_byte_);
  per_byte_ = std::clamp(per_byte_, kLeast, kMost);
}

}  // namespace rimlight
