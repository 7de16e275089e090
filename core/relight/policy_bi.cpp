#include <algorithm>

#include "core/relight/plan_storage.h"
#include "core/relight/policies.h"

namespace rimlight {

void BiPolicy::plan_checked(const PlanRequest& request, PlanWorkspace::Storage& storage,
                            UpdatePlan& plan) const {
  // From a light that holds nothing the two are the same.
  const bool starts =
      std::ranges::all_of(request.held.values, [](float value) { return value == 0; });
  const Alternative alternative = starts ? Alternative::reset : Alternative::increment;
  measure_sizes(request, selection_, alternative, storage.gains_of(alternative));
  storage.actions.assign(static_cast<std::size_t>(request.basis.band_count()),
                         starts ? BandAction::reset : BandAction::increment);
  plan_best_columns(request, storage, plan);
}

}  // namespace rimlight
