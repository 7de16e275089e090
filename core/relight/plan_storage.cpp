#include "core/relight/plan_storage.h"

namespace rimlight {
namespace {

Alternative alternative_of(BandAction action) {
  return action == BandAction::reset ? Alternative::reset : Alternative::increment;
}

}  // namespace

void PlanWorkspace::Storage::rank_all(const PlanRequest& request, const Candidates& candidates) {
  const ColumnCosts costs(request, candidates);
  ranked.clear();
  for (int band = 0; band < request.basis.band_count(); ++band) {
    for (const auto alternative : {Alternative::increment, Alternative::reset}) {
      ranked.add(candidates, band, alternative, gains_of(alternative), costs);
    }
  }
  ranked.sort();
}

void plan_best_columns(const PlanRequest& request, PlanWorkspace::Storage& storage,
                       UpdatePlan& plan) {
  const auto candidates = Candidates::columns(request.basis);
  const ColumnCosts costs(request, candidates);
  storage.ranked.clear();
  for (int band = 0; band < request.basis.band_count(); ++band) {
    const Alternative alternative = alternative_of(storage.actions[static_cast<std::size_t>(band)]);
    storage.ranked.add(candidates, band, alternative, storage.gains_of(alternative), costs);
  }
  storage.ranked.sort();
  take_best(storage.ranked, ~ListSet{0}, costs, BudgetWalk(costs.budget()), storage.columns);
  write_plan(request, candidates, storage.actions, storage.columns, plan);
}

}  // namespace rimlight
