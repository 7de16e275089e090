#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/relight/design_state.h"
#include "core/transport/bake_folder.h"

namespace rimlight {

/// The environments that a renderer can show, by name.
class ShownEnvironments {
 public:
  explicit ShownEnvironments(const std::vector<BakedEnvironment>& environments);

  /// Throws Error, naming those that there are, when there is none of that name.
  const BakedEnvironment& at(const std::string& name) const;
  /// In the place of one of the same name.
  void set(const BakedEnvironment& environment);
  /// What radiance is multiplied by before tone mapping.
  float exposure_of(const DesignState& state) const;

 private:
  std::map<std::string, BakedEnvironment> environments_;
};

}  // namespace rimlight
