#pragma once

#include <array>
#include <vector>

#include "core/relight/band_dealer.h"
#include "core/relight/column_gains.h"
#include "core/relight/plan_writer.h"
#include "core/relight/policy.h"
#include "core/relight/ranked_columns.h"
#include "core/relight/reset_search.h"

namespace rimlight {

/// What policies compute on the way to a plan.
struct PlanWorkspace::Storage {
  std::array<ColumnGains, 2> gains;  // [Alternative]
  RankedColumns ranked;
  ResetSearch search;
  BandDealer dealer;
  std::vector<BandAction> actions;  // [bands]
  ColumnSet columns;

  ColumnGains& gains_of(Alternative alternative) {
    return gains[static_cast<std::size_t>(alternative)];
  }
  /// Ranks both lists of every band, from gains of both alternatives.
  void rank_all(const PlanRequest& request, const Candidates& candidates);
};

/// The plan that increments or resets bands as storage.actions say, and spends the budget on their
/// best columns, all bands together. Reads the gains of the alternatives that the actions name.
void plan_best_columns(const PlanRequest& request, PlanWorkspace::Storage& storage,
                       UpdatePlan& plan);

}  // namespace rimlight
