#include "core/relight/plan_storage.h"
#include "core/relight/policies.h"

namespace rimlight {

void BiPolicy::plan_checked(const PlanRequest& request, PlanWorkspace::Storage& storage,
                            UpdatePlan& plan) const {
  // From a light that holds nothing the two are the same.
  bool starts = true;
  for (int band = 0; band < request.basis.band_count(); ++band) {
    starts = starts && holds_nothing(request, band);
  }
  const Alternative alternative = starts ? Alternative::reset : Alternative::increment;
  measure_sizes(request, selection_, alternative, storage.gains_of(alternative));
  storage.actions.assign(static_cast<std::size_t>(request.basis.band_count()),
                         starts ? BandAction::reset : BandAction::increment);
  plan_best_columns(request, storage, plan);
}

}  // namespace rimlight
