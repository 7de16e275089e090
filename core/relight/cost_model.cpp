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
  constexpr double kUp = 0.5, kDown = 0.1;
  if (bytes < kFewestBytes) return;
  const double measured =
      std::clamp((milliseconds - kFixedMs) / static_cast<double>(bytes), kLeast, kMost);
  per_byte_ += (measured - per_byte_) * (measured > per_byte_ ? kUp : kDown);
}

}  // namespace rimlight
