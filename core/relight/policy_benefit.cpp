#include "core/relight/plan_storage.h"
#include "core/relight/policies.h"

namespace rimlight {
namespace {

/// Layers by themselves where their costs and norms are known: the budget counts bytes.
Candidates candidates_of(const PlanRequest& request) {
  const bool known = !request.part_bytes.empty() && !request.part_norm_squared.empty();
  return known && request.budget.unit == Budget::Unit::bytes ? Candidates::parts(request.basis)
                                                             : Candidates::columns(request.basis);
}

}  // namespace

void BenefitPolicy::plan_checked(const PlanRequest& request, PlanWorkspace::Storage& storage,
                                 UpdatePlan& plan) const {
  const Candidates candidates = candidates_of(request);
  for (const auto alternative : {Alternative::increment, Alternative::reset}) {
    measure_energies(request, candidates, alternative, storage.gains_of(alternative));
  }
  storage.rank_all(request, candidates);
  const ColumnCosts costs(request, candidates);
  const std::uint64_t reset_cost = costs.are_bytes() ? request.band_image_bytes : 0;
  const ResetAnswer& answer =
      storage.search.run({request, candidates, storage.ranked, storage.gains, reset_cost});
  storage.columns.clear(candidates.count());
  take_best(storage.ranked, answer.lists, costs, BudgetWalk(answer.columns_budget),
            storage.columns);
  write_plan(request, candidates, answer.actions, storage.columns, plan);
}

}  // namespace rimlight
