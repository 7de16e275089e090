#pragma once

#include <string>
#include <vector>

#include "core/curves/curve_updater.h"

namespace rimlight {

/// A policy of curve updates, and what one of its frames may cost. As text POLICY@BUDGET: "bi@30",
/// "benefit@16ms", "nwa@4MB".
struct CurveRun {
  CurvePolicy policy = CurvePolicy::benefit;
  FrameBudget budget;

  std::string name() const;
};

std::string curve_policy_name(CurvePolicy policy);

/// Throws Error naming `where`.
CurveRun parse_curve_run(const std::string& text, const std::string& where);

/// Each policy with 1 … 256 terms, with bytes and with milliseconds; all of one budget in a row.
std::vector<CurveRun> default_curve_runs();

}  // namespace rimlight
