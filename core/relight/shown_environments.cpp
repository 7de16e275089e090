#include "core/relight/shown_environments.h"

#include <cmath>

#include "core/base/error.h"

namespace rimlight {

ShownEnvironments::ShownEnvironments(const std::vector<BakedEnvironment>& environments) {
  for (const BakedEnvironment& baked : environments) set(baked);
}

const BakedEnvironment& ShownEnvironments::at(const std::string& name) const {
  const auto found = environments_.find(name);
  if (found != environments_.end()) return found->second;
  std::string names;
  for (const auto& item : environments_) names += " " + quote(item.first);
  throw Error("environment", quote(name), "one of" + names);
}

void ShownEnvironments::set(const BakedEnvironment& environment) {
  environments_.insert_or_assign(environment.environment->name(), environment);
}

float ShownEnvironments::exposure_of(const DesignState& state) const {
  return static_cast<float>(at(state.environment).exposure_scale * std::exp2(state.exposure_stops));
}

}  // namespace rimlight
