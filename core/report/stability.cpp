#include "core/report/stability.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>

#include "core/base/error.h"
#include "core/base/stopwatch.h"
#include "core/report/report_files.h"
#include "core/report/stability/cases.h"

namespace rimlight {
namespace {

using nlohmann::json;

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

/// Throws Error for a name that `field` of no case has.
void check_names(const std::vector<std::string>& names, std::string StabilityCase::*field,
                 const std::string& where) {
  for (const std::string& name : names) {
    const auto has = [&](const StabilityCase& one) { return one.*field == name; };
    if (std::ranges::any_of(stability_cases(), has)) continue;
    std::string all;
    for (const StabilityCase& one : stability_cases()) {
      if (!all.ends_with(" " + one.*field)) all += " " + one.*field;
    }
    throw Error(where, quote(name), "one of" + all);
  }
}

bool is_chosen(const StabilityCase& one, const StabilitySettings& settings) {
  if (contains(settings.broken, one.name) || contains(settings.cases, one.name)) return true;
  if (!settings.parts.empty()) return contains(settings.parts, one.part);
  return settings.cases.empty() && settings.broken.empty();
}

}  // namespace

const std::vector<StabilityCase>& stability_cases() {
  static const std::vector<StabilityCase> all = [] {
    std::vector<StabilityCase> cases;
    for (const auto part :
         {stability::light_cases, stability::storage_cases, stability::drift_cases,
          stability::rotation_cases, stability::harmonics_cases, stability::interreflection_cases,
          stability::fits_cases, stability::materials_cases, stability::geometry_cases,
          stability::numbers_cases, stability::receivers_cases, stability::budgets_cases}) {
      for (StabilityCase& one : part()) cases.push_back(std::move(one));
    }
    return cases;
  }();
  return all;
}

StabilityRow measure_case(const StabilityCase& one, const StabilityTrial& trial) {
  const Stopwatch watch;
  StabilityRow row;
  row.of = &one;
  try {
    row.measured = one.measure(trial);
  } catch (const std::exception& failure) {
    row.measured = {std::numeric_limits<double>::quiet_NaN(), failure.what()};
  }
  row.seconds = watch.elapsed_seconds();
  row.pass = keeps_bound(one, row.measured.value);
  return row;
}

bool keeps_bound(const StabilityCase& of, double value) {
  return of.kind == BoundKind::at_most ? value <= of.bound : value >= of.bound;
}

std::vector<StabilityRow> measure_stability(
    const StabilitySettings& settings,
    const std::function<void(const std::string& name, double share)>& progress) {
  check_names(settings.cases, &StabilityCase::name, "--case");
  check_names(settings.broken, &StabilityCase::name, "--break");
  check_names(settings.parts, &StabilityCase::part, "--part");
  std::vector<const StabilityCase*> chosen;
  for (const StabilityCase& one : stability_cases()) {
    if (is_chosen(one, settings)) chosen.push_back(&one);
  }
  std::vector<StabilityRow> rows;
  for (const StabilityCase* const one : chosen) {
    const double share = static_cast<double>(rows.size()) / static_cast<double>(chosen.size());
    if (progress) progress(one->name, share);
    StabilityTrial trial = settings.trial;
    trial.broken = trial.broken || contains(settings.broken, one->name);
    rows.push_back(measure_case(*one, trial));
  }
  if (progress) progress("done", 1);
  return rows;
}

json to_json(std::span<const StabilityRow> rows) {
  json cases = json::array();
  for (const StabilityRow& row : rows) {
    const StabilityCase& of = *row.of;
    json measured = nullptr;
    if (std::isfinite(row.measured.value)) measured = row.measured.value;
    cases.push_back({{"case", of.name},
                     {"part", of.part},
                     {"quantity", of.quantity},
                     {"bound_is", of.kind == BoundKind::at_most ? "at most" : "at least"},
                     {"bound", of.bound},
                     {"measured", measured},
                     {"pass", row.pass},
                     {"why", of.why},
                     {"note", row.measured.note},
                     {"seconds", row.seconds}});
  }
  const auto failed =
      std::ranges::count_if(rows, [](const StabilityRow& row) { return !row.pass; });
  return {{"experiment", "stability"},
          {"machine", describe_machine()},
          {"rows", cases},
          {"failed", failed}};
}

Figures draw_figures(std::span<const StabilityRow>, const std::filesystem::path&) { return {}; }

}  // namespace rimlight
