#include "core/report/curve_run.h"

#include <array>

#include "core/base/error.h"

namespace rimlight {
namespace {

constexpr std::array kPolicies{CurvePolicy::nwa, CurvePolicy::bi, CurvePolicy::benefit};

}  // namespace

std::string curve_policy_name(CurvePolicy policy) {
  switch (policy) {
    case CurvePolicy::nwa:
      return "nwa";
    case CurvePolicy::bi:
      return "bi";
    case CurvePolicy::benefit:
      break;
  }
  return "benefit";
}

std::string CurveRun::name() const { return curve_policy_name(policy) + "@" + budget_name(budget); }

CurveRun parse_curve_run(const std::string& text, const std::string& where) {
  const std::size_t at = text.find('@');
  if (at == std::string::npos) {
    throw Error(where, quote(text), "a policy and its budget, such as bi@30 or benefit@16ms");
  }
  for (const CurvePolicy policy : kPolicies) {
    if (curve_policy_name(policy) == text.substr(0, at)) {
      return {policy, parse_budget(text.substr(at + 1), where)};
    }
  }
  throw Error(where, quote(text.substr(0, at)), R"(one of "nwa" "bi" "benefit")");
}

std::vector<CurveRun> default_curve_runs() {
  std::vector<CurveRun> runs;
  for (const char* const budget : {"1", "2", "5", "10", "20", "30", "60", "100", "256", "4MB",
                                   "16MB", "64MB", "1ms", "2ms", "4ms", "8ms", "16ms"}) {
    for (const CurvePolicy policy : kPolicies) {
      runs.push_back({policy, parse_budget(budget, "default budgets")});
    }
  }
  return runs;
}

}  // namespace rimlight
