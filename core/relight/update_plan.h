#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/transport/column_kernel.h"

namespace rimlight {

/// Appends some layers of a column, each with its delta: those that have the same go together,
/// those whose delta is zero are left out.
void append_deltas(std::size_t column, const std::array<Vec3f, kLayers>& deltas, LayerSet layers,
                   std::vector<ColumnDelta>& columns);

/// What happens to a band's image B_i and its held coefficients before columns are added:
///   hold       nothing; no column is added either
///   increment  nothing; deltas are target − held (Overbeck 2006, eq. 4.2–4.5)
///   reset      both become zero; deltas are the target itself (eq. 4.1)
enum class BandAction : std::uint8_t { hold, reset, increment };

/// One band's part of an update: an action, and a range of UpdatePlan::columns.
struct BandUpdate {
  BandAction action = BandAction::hold;
  std::size_t first = 0, count = 0;
};

/// How the next image comes about: for each band, coarsest first, what to do and which columns to
/// add. Columns ascend, so that the kernel streams through the transport; one may come several
/// times, with different layers.
struct UpdatePlan {
  std::vector<BandUpdate> bands;     // [bands of the basis]
  std::vector<ColumnDelta> columns;  // all bands', ascending

  /// Columns, however many layers of each.
  std::size_t column_count() const;
};

}  // namespace rimlight
