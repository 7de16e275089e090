#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/relight/column_gains.h"
#include "core/relight/policy.h"
#include "core/relight/update_plan.h"

namespace rimlight {

/// A set of columns that can be listed in ascending order at once.
class ColumnSet {
 public:
  /// Empty, of columns below `columns`.
  void clear(std::size_t columns) { words_.assign((columns + 63) / 64, 0); }
  void insert(std::size_t column) { words_[column / 64] |= std::uint64_t{1} << (column % 64); }
  std::size_t size() const;
  const std::vector<std::uint64_t>& words() const { return words_; }

 private:
  std::vector<std::uint64_t> words_;
};

/// The plan that treats bands as `actions` say (increment or reset, [bands]) and applies `columns`
/// of the candidates; an increment by no column becomes hold. Layers of a column that have the same
/// delta go together, those whose delta is zero are left out.
void write_plan(const PlanRequest& request, const Candidates& candidates,
                const std::vector<BandAction>& actions, const ColumnSet& columns, UpdatePlan& plan);

}  // namespace rimlight
