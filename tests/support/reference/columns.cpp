#include "tests/support/reference/columns.h"

#include <cmath>

namespace rimlight::reference {

HeldTile add_columns(const TransportView& transport, std::size_t tile,
                     std::span<const ColumnDelta> columns, std::span<const float> held) {
  HeldTile result;
  for (const float value : held) {
    result.value.push_back(value);
    result.magnitude.push_back(std::abs(value));
  }
  for (const ColumnDelta& column : columns) {
    const double step = transport.step(column.column);
    for (RunCursor at(transport.run(tile, column.column)); !at.at_end(); at.next()) {
      if ((column.layers >> layer_of(at.width()) & 1) == 0) continue;
      const RunBlock block = at.block();
      for (std::size_t i = 0; i < kBlockFloats; ++i) {
        const auto channel = static_cast<int>(i / kBlockReceivers);
        const double m = kPlaneFactors[block.plane][channel] * step *
                         static_cast<double>(block.value[i % kBlockReceivers]);
        const double term = column.delta[channel] * m;
        result.value[block.index * kBlockFloats + i] += term;
        result.magnitude[block.index * kBlockFloats + i] += std::abs(term);
      }
    }
  }
  return result;
}

}  // namespace rimlight::reference
