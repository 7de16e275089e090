#include "core/relight/error_estimate.h"

#include <array>
#include <cmath>
#include <span>

#include "core/base/check.h"
#include "core/base/parallel.h"

namespace rimlight {

ErrorEstimate ErrorEstimator::estimate(const CubeLight& target, const HeldLight& held) {
  const std::size_t columns = sketch_.column_count, parts = columns * kLayers;
  RIMLIGHT_CHECK_EQ(target.count(), columns);
  RIMLIGHT_CHECK_EQ(held.count(), columns);
  residual_.resize(3 * parts);
  // Ranges of columns that do not depend on the threads, and neither do the sums.
  constexpr std::size_t kRanges = 8;
  std::array<std::array<SketchedImages, kRanges>, 3> sketched;
  const auto sketch_range = [&](std::size_t i) {
    const std::size_t c = i / kRanges, range = i % kRanges;
    const std::size_t first = columns * range / kRanges, end = columns * (range + 1) / kRanges;
    const auto wanted = target.channel(static_cast<int>(c));
    const auto residual = std::span(residual_).subspan(c * parts, parts);
    for (std::size_t layer = 0; layer < kLayers; ++layer) {
      const auto shown = held.layer(layer).channel(static_cast<int>(c));
      for (std::size_t column = first; column < end; ++column) {
        residual[part_of(column, layer)] = wanted[column] - shown[column];
      }
    }
    sketched[c][range] = sketch_images(sketch_, c, residual, wanted, first, end - first);
  };
  parallel_for(3 * kRanges, sketch_range);
  ErrorEstimate estimate;
  for (auto& channel : sketched) {
    for (std::size_t range = 1; range < kRanges; ++range) channel[0] += channel[range];
    estimate.error += channel[0].error_squared();
    estimate.residual += channel[0].residual_squared();
  }
  return {std::sqrt(estimate.error), std::sqrt(estimate.residual)};
}

}  // namespace rimlight
