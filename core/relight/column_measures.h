#pragma once

#include <cstdint>
#include <vector>

#include "core/transport/transport.h"

namespace rimlight {

/// What policies weigh the columns of M by.
struct ColumnMeasures {
  std::vector<float> norm_squared;  // [3][columns]: Σ M² over receivers
  std::vector<std::uint32_t> bytes;  // [columns]: of its blocks, indices and values, at most 2³²−1
};

/// Reads the whole transport once, on all threads. Sums in double, tile by tile: the same bits at
/// any thread count.
ColumnMeasures measure_columns(const TransportView& transport);

}  // namespace rimlight
