#pragma once

#include <string>
#include <vector>

#include "core/relight/frame_update.h"
#include "core/relight/policy_settings.h"

namespace rimlight {

/// A policy and what one of its frames may cost. As text: POLICY@BUDGET, "pbi@30", "benefit@16ms";
/// or what another's frames cost: POLICY@OTHER@BUDGET, "benefit@pbi@30", in time;
/// POLICY@bytes:OTHER@BUDGET in bytes of transport, which no busy machine disturbs.
struct TimedPolicy {
  PolicySettings policy;
  /// Milliseconds are of a whole frame, from its light to its JPEG. Where there is another policy,
  /// the amount is the median of its frames in motion in the same run, and unknown until then.
  FrameBudget budget;
  std::string other;  // the name of the policy that this one spends as much as; empty: none

  std::string name() const;
};

/// Throws Error naming `where`.
TimedPolicy parse_timed_policy(const std::string& text, const std::string& where);

/// What a report compares unless told otherwise: the papers' policies with their budgets, and
/// benefit in the same time.
std::vector<TimedPolicy> default_timed_policies();

}  // namespace rimlight
