#include "core/relight/plan_storage.h"
#include "core/relight/policies.h"

namespace rimlight {

void NwaPolicy::plan_checked(const PlanRequest& request, PlanWorkspace::Storage& storage,
                             UpdatePlan& plan) const {
  measure_sizes(request, selection_, Alternative::reset, storage.gains_of(Alternative::reset));
  storage.actions.assign(static_cast<std::size_t>(request.basis.band_count()), BandAction::reset);
  plan_best_columns(request, storage, plan);
}

}  // namespace rimlight
