#include "core/relight/plan_storage.h"
#include "core/relight/policies.h"

namespace rimlight {

void LinearPolicy::plan_checked(const PlanRequest& request, PlanWorkspace::Storage& storage,
                                UpdatePlan& plan) const {
  const auto columns = Candidates::columns(request.basis);
  const ColumnCosts costs(request, columns);
  std::uint64_t left = costs.budget();
  for (std::size_t column = 0; column < request.target.count(); ++column) {
    if (costs.of(column) > left) break;
    left -= costs.of(column);
    if (request.target.at(column) != Vec3f{}) storage.columns.insert(column);
  }
  storage.actions.assign(static_cast<std::size_t>(request.basis.band_count()), BandAction::reset);
  write_plan(request, columns, storage.actions, storage.columns, plan);
}

}  // namespace rimlight
