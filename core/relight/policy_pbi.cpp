#include "core/relight/plan_storage.h"
#include "core/relight/policies.h"

namespace rimlight {
namespace {

/// Each band by itself, before any column is chosen.
void plan_simply(const PlanRequest& request, PlanWorkspace::Storage& storage, UpdatePlan& plan) {
  storage.actions.clear();
  const auto columns = Candidates::columns(request.basis);
  for (int band = 0; band < request.basis.band_count(); ++band) {
    const double kept = storage.gains_of(Alternative::increment).of_band(columns, band);
    const double fresh = storage.gains_of(Alternative::reset).of_band(columns, band);
    // Where nothing is wrong that is measured, there is nothing to reset for.
    const bool keeps = kept > 0 ? kept < fresh : !holds_nothing(request, band);
    storage.actions.push_back(keeps ? BandAction::increment : BandAction::reset);
  }
  plan_best_columns(request, storage, plan);
}

}  // namespace

void PbiPolicy::plan_checked(const PlanRequest& request, PlanWorkspace::Storage& storage,
                             UpdatePlan& plan) const {
  for (const auto alternative : {Alternative::increment, Alternative::reset}) {
    measure_sizes(request, selection_, alternative, storage.gains_of(alternative));
  }
  if (band_test_ == BandTest::simple) return plan_simply(request, storage, plan);
  const auto columns = Candidates::columns(request.basis);
  storage.rank_all(request, columns);
  if (band_test_ == BandTest::dealer) {
    storage.dealer.run(request, storage.ranked, storage.gains, storage.actions, storage.columns);
    write_plan(request, columns, storage.actions, storage.columns, plan);
  } else {
    constexpr std::uint64_t kNoCost = 0;
    const ResetAnswer& answer =
        storage.search.run({request, columns, storage.ranked, storage.gains, kNoCost});
    take_best(storage.ranked, answer.lists, ColumnCosts(request, columns),
              BudgetWalk(answer.columns_budget), storage.columns);
    write_plan(request, columns, answer.actions, storage.columns, plan);
  }
}

}  // namespace rimlight
