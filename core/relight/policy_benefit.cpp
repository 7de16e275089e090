#include "core/relight/plan_storage.h"
#include "core/relight/policies.h"

namespace rimlight {

void BenefitPolicy::plan_checked(const PlanRequest& request, PlanWorkspace::Storage& storage,
                                 UpdatePlan& plan) const {
  for (const auto alternative : {Alternative::increment, Alternative::reset}) {
    measure_energies(request, alternative, storage.gains_of(alternative));
  }
  storage.rank_all(request);
  const ColumnCosts costs(request);
  const std::uint64_t reset_cost = costs.are_bytes() ? request.band_image_bytes : 0;
  const ResetAnswer& answer =
      storage.search.run({request, storage.ranked, storage.gains, reset_cost});
  take_best(storage.ranked, answer.lists, costs, BudgetWalk(answer.columns_budget),
            storage.columns);
  write_plan(request, answer.actions, storage.columns, plan);
}

}  // namespace rimlight
