#include "core/relight/error_estimate.h"

#include <array>
#include <cmath>
#include <functional>

#include "core/base/check.h"
#include "core/base/parallel.h"

namespace rimlight {

ErrorEstimate ErrorEstimator::estimate(const CubeLight& target, const CubeLight& held) {
  RIMLIGHT_CHECK_EQ(target.count(), sketch_.column_count);
  RIMLIGHT_CHECK_EQ(held.count(), sketch_.column_count);
  residual_ = target;
  for (std::size_t i = 0; i < residual_.values.size(); ++i) residual_.values[i] -= held.values[i];
  std::array<SketchedSquares, 3> squares;
  const auto of_channel = [&](std::size_t c) {
    const auto channel = static_cast<int>(c);
    squares[c] = sketched_squares(sketch_, c, residual_.channel(channel), target.channel(channel));
  };
  parallel_for(squares.size(), std::cref(of_channel));
  ErrorEstimate estimate;
  for (const SketchedSquares& channel : squares) {
    estimate.error += channel.error;
    estimate.residual += channel.residual;
  }
  return {std::sqrt(estimate.error), std::sqrt(estimate.residual)};
}

}  // namespace rimlight
