#include "tests/support/reference/columns.h"

#include <cmath>

namespace rimlight::reference {

TileRadiance add_columns(const TransportView& transport, std::size_t tile,
                         std::span<const ColumnDelta> columns, std::span<const float> radiance) {
  TileRadiance result;
  for (const float value : radiance) {
    result.value.push_back(value);
    result.magnitude.push_back(std::abs(value));
  }
  for (const ColumnDelta& column : columns) {
    const ColumnRun run = transport.run(tile, column.column);
    for (std::size_t b = 0; b < run.block_index.size(); ++b) {
      for (std::size_t i = 0; i < kBlockFloats; ++i) {
        const double delta = column.delta[static_cast<int>(i / kBlockReceivers)];
        const double m = static_cast<double>(to_float(run.values[b * kBlockFloats + i])) *
                         static_cast<double>(run.scale);
        const std::size_t at = run.block_index[b] * kBlockFloats + i;
        result.value[at] += delta * m;
        result.magnitude[at] += std::abs(delta * m);
      }
    }
  }
  return result;
}

}  // namespace rimlight::reference
