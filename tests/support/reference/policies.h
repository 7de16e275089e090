#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "core/relight/policy.h"
#include "core/relight/policy_settings.h"

namespace rimlight::reference {

/// What a column adds to the error as long as its delta is not applied.
using Measure = std::function<double(std::size_t column, const Vec3d& delta)>;
/// Weighted L1, as nwa, bi and pbi select.
Measure size_measure(const PlanRequest& request, Selection selection);
/// Squared error of the image, as benefit has it.
Measure energy_measure(const PlanRequest& request);

/// A plan as a set: which bands are reset, and which columns applied, ascending.
struct Choice {
  std::vector<bool> reset;  // [bands]
  std::vector<std::size_t> columns;
  double error = 0;
};
Choice choice_of(const PlanRequest& request, const UpdatePlan& plan, const Measure& measure);

/// The error that is left: Σ of the measure over columns that are not applied.
double error_of(const PlanRequest& request, const Choice& choice, const Measure& measure);
/// What the budget counts: columns, or their bytes and those of the images of reset bands that held
/// something and get columns.
std::size_t cost_of(const PlanRequest& request, const Choice& choice);

/// The best columns of bands treated so, by sorting all of them: largest first, of equals the lower
/// index; in bytes by measure per byte if `per_byte`, up to the first that does not fit.
enum class Order { by_measure, per_byte };
Choice best_columns(const PlanRequest& request, const std::vector<bool>& reset,
                    const Measure& measure, Order order);

/// Overbeck 2006, §6.2.1 and 6.2.3, each step computed afresh. Budgets in coefficients.
Choice exhaustive(const PlanRequest& request, const Measure& measure);
Choice dealer(const PlanRequest& request, const Measure& measure);

/// The least error of all: every subset of the columns that are not zero under every set of resets.
double least_error(const PlanRequest& request, const Measure& measure);

}  // namespace rimlight::reference
