#pragma once

#include <span>
#include <vector>

#include "core/transport/column_kernel.h"
#include "core/transport/transport.h"

namespace rimlight::reference {

/// held += delta · M[column] for one tile, in double, and beside it the sum of all magnitudes that
/// were added: what rounding errors scale with.
struct HeldTile {
  std::vector<double> value;      // [block][3][8]
  std::vector<double> magnitude;  // the same
};
HeldTile add_columns(const TransportView& transport, std::size_t tile,
                     std::span<const ColumnDelta> columns, std::span<const float> held);

}  // namespace rimlight::reference
