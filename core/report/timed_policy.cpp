#include "core/report/timed_policy.h"

#include "core/base/error.h"

namespace rimlight {
namespace {

constexpr std::string_view kBytesOf = "bytes:";

}  // namespace

std::string TimedPolicy::name() const {
  const std::string start = policy_name(policy) + "@";
  if (other.empty()) return start + budget_name(budget);
  return start + std::string(budget.unit == FrameBudget::Unit::bytes ? kBytesOf : "") + other;
}

TimedPolicy parse_timed_policy(const std::string& text, const std::string& where) {
  const std::size_t at = text.find('@');
  if (at == std::string::npos) {
    throw Error(where, quote(text), "a policy and its budget, such as pbi@30 or benefit@16ms");
  }
  TimedPolicy result;
  result.policy = parse_policy(text.substr(0, at), where);
  std::string rest = text.substr(at + 1);
  if (rest.find('@') == std::string::npos) {
    result.budget = parse_budget(rest, where);
    return result;
  }
  const bool in_bytes = rest.starts_with(kBytesOf);
  if (in_bytes) rest.erase(0, kBytesOf.size());
  const TimedPolicy other = parse_timed_policy(rest, where);
  if (!other.other.empty()) throw Error(where, quote(text), "at most one other policy");
  result.other = other.name();
  result.budget.unit = in_bytes ? FrameBudget::Unit::bytes : FrameBudget::Unit::milliseconds;
  return result;
}

std::vector<TimedPolicy> default_timed_policies() {
  std::vector<TimedPolicy> result;
  for (const char* const text : {"nwa@30", "nwa@60", "nwa@100", "nwa@500", "bi@30", "pbi@30",
                                 "benefit@pbi@30", "benefit@bytes:pbi@30", "pbi@100",
                                 "benefit@pbi@100", "benefit@bytes:pbi@100", "benefit@16ms"}) {
    result.push_back(parse_timed_policy(text, "default policies"));
  }
  return result;
}

}  // namespace rimlight
