#pragma once

#include <string>
#include <vector>

#include "core/relight/frame_update.h"
#include "core/relight/policy_settings.h"

namespace rimlight {

/// A policy and what one of its frames may cost. As text: POLICY@BUDGET, "pbi@30", "benefit@16ms";
/// or POLICY@OTHER@BUDGET, "benefit@pbi@30": as long as that other's frames took.
struct TimedPolicy {
  PolicySettings policy;
  /// Milliseconds are of a whole frame, from its light to its JPEG. When `as_long_as` is not empty,
  /// it is the median of that one's moving frames in the same run, and unknown until then.
  FrameBudget budget;
  std::string as_long_as;  // a timed policy's name

  std::string name() const;
};

/// Throws Error naming `where`.
TimedPolicy parse_timed_policy(const std::string& text, const std::string& where);

/// What a report compares unless told otherwise: the papers' policies with their budgets, and
/// benefit in the same time.
std::vector<TimedPolicy> default_timed_policies();

}  // namespace rimlight
