#include "core/relight/error_estimate.h"

#include <array>
#include <cmath>
#include <functional>
#include <span>

#include "core/base/check.h"
#include "core/base/parallel.h"

namespace rimlight {

ErrorEstimate ErrorEstimator::estimate(const CubeLight& target, const HeldLight& held) {
  const std::size_t columns = sketch_.column_count, parts = columns * kLayers;
  RIMLIGHT_CHECK_EQ(target.count(), columns);
  RIMLIGHT_CHECK_EQ(held.count(), columns);
  residual_.resize(3 * parts);
  std::array<SketchedSquares, 3> squares;
  const auto of_channel = [&](std::size_t c) {
    const auto wanted = target.channel(static_cast<int>(c));
    const auto residual = std::span(residual_).subspan(c * parts, parts);
    for (std::size_t layer = 0; layer < kLayers; ++layer) {
      const auto shown = held.layer(layer).channel(static_cast<int>(c));
      for (std::size_t i = 0; i < columns; ++i) {
        residual[part_of(i, layer)] = wanted[i] - shown[i];
      }
    }
    squares[c] = sketched_squares(sketch_, c, residual, wanted);
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
