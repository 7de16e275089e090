#include "core/relight/column_measures.h"

#include <algorithm>
#include <array>
#include <limits>

#include "core/base/parallel.h"

namespace rimlight {
namespace {

constexpr std::size_t kBlockBytes = sizeof(std::uint16_t) + kBlockFloats * sizeof(Half);

/// Σ of squares of a run, per channel.
std::array<double, 3> squares_of(const ColumnRun& run) {
  std::array<double, 3> sums = {};
  for (std::size_t i = 0; i < run.block_index.size() * kBlockFloats; ++i) {
    const double value = to_float(run.values[i]);
    sums[i % kBlockFloats / kBlockReceivers] += value * value;
  }
  for (double& sum : sums) sum *= double{run.scale} * double{run.scale};
  return sums;
}

}  // namespace

ColumnMeasures measure_columns(const TransportView& transport) {
  const std::size_t columns = transport.column_count();
  ColumnMeasures measures;
  measures.norm_squared.resize(3 * columns);
  measures.bytes.resize(columns);
  const auto measure = [&](std::size_t column) {
    std::array<double, 3> sums = {};
    std::size_t bytes = 0;
    for (std::size_t tile = 0; tile < transport.tile_count(); ++tile) {
      const ColumnRun run = transport.run(tile, column);
      const auto squares = squares_of(run);
      for (std::size_t c = 0; c < 3; ++c) sums[c] += squares[c];
      bytes += run.block_index.size() * kBlockBytes;
    }
    constexpr std::size_t kMost = std::numeric_limits<std::uint32_t>::max();
    measures.bytes[column] = static_cast<std::uint32_t>(std::min(bytes, kMost));
    for (std::size_t c = 0; c < 3; ++c) {
      measures.norm_squared[c * columns + column] = static_cast<float>(sums[c]);
    }
  };
  parallel_for(columns, measure);
  return measures;
}

}  // namespace rimlight
