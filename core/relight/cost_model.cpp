#include "core/relight/cost_model.h"

#include <algorithm>

namespace rimlight {

std::size_t CostModel::work_within(double milliseconds) const {
  constexpr double kMostWork = 1e15;  // more than any transport is; fits an integer
  return static_cast<std::size_t>(
      std::clamp((milliseconds - kFixedMs) / per_unit_, 0.0, kMostWork));
}

void CostModel::learn(std::size_t work, double milliseconds) {
  constexpr std::size_t kLeastWork = 200'000;    // below, the fixed part hides the rest
  constexpr double kLeast = 1e-9, kMost = 1e-4;  // a block in 8 ps, in 0.8 µs
  constexpr double kShare = 0.3;
  constexpr double kMostAtOnce = 3;  // a frame that lost its core says nothing about the next
  constexpr double kHope = 0.9;
  if (work < kLeastWork) {
    per_unit_ = std::max(kLeast, kHope * per_unit_);
    return;
  }
  const double measured = (milliseconds - kFixedMs) / static_cast<double>(work);
  per_unit_ += kShare * (std::min(measured, kMostAtOnce * per_unit_) - per_unit_);
  per_unit_ = std::clamp(per_unit_, kLeast, kMost);
}

}  // namespace rimlight
