#include "core/relight/frame_update.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/base/error.h"
#include "core/base/stopwatch.h"

namespace rimlight {
namespace {

/// Of a deadline's time the first batch is planned for this share: what it then takes tells how
/// much more there is.
constexpr double kFirstShare = 0.85;
constexpr double kNextShare = 0.9;
constexpr int kMostBatches = 4;
/// Time too short for another batch: planning alone takes a good part of it.
constexpr double kShortestBatchMs = 0.6;

/// What applying each column takes as the cost model counts: its bytes, and for each tile the
/// looking up of a run, which takes about as long as reading kBytesPerRun.
std::vector<std::uint32_t> count_column_costs(std::span<const std::uint32_t> column_bytes,
                                              std::size_t tile_count) {
  constexpr std::uint64_t kBytesPerRun = 64;
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> costs;
  for (const std::uint32_t bytes : column_bytes) {
    costs.push_back(static_cast<std::uint32_t>(std::min(kMost, bytes + tile_count * kBytesPerRun)));
  }
  return costs;
}

}  // namespace

FrameBudget parse_budget(const std::string& text, const std::string& where) {
  double amount = 0;
  const auto [rest, fault] = std::from_chars(text.data(), text.data() + text.size(), amount);
  const std::string unit(rest, text.data() + text.size());
  if (fault == std::errc() && amount >= 0 && amount <= 1e12) {
    if (unit.empty() && amount == std::floor(amount)) {
      return {FrameBudget::Unit::coefficients, amount};
    }
    if (unit == "MB") return {FrameBudget::Unit::bytes, amount * 1e6};
    if (unit == "ms") return {FrameBudget::Unit::milliseconds, amount};
  }
  throw Error(where, quote(text), "a budget such as 30 (coefficients), 2MB or 16ms");
}

std::string budget_name(const FrameBudget& budget) {
  char digits[32];
  const double shown =
      budget.unit == FrameBudget::Unit::bytes ? budget.amount / 1e6 : budget.amount;
  const auto end = std::to_chars(digits, digits + sizeof digits, shown).ptr;
  const char* const unit = budget.unit == FrameBudget::Unit::coefficients ? ""
                           : budget.unit == FrameBudget::Unit::bytes      ? "MB"
                                                                          : "ms";
  return std::string(digits, end) + unit;
}

FrameBudget reduce_deadline(const FrameBudget& budget, double taken_ms) {
  if (budget.unit != FrameBudget::Unit::milliseconds) return budget;
  return {budget.unit, std::max(0.0, budget.amount - taken_ms)};
}

FrameUpdater::FrameUpdater(const Bake& bake, const CubeHaar& basis, const PolicySettings& policy,
                           Relighter& relighter)
    : bake_(bake),
      basis_(basis),
      policy_(make_policy(policy)),
      keeps_nothing_(policy.kind == PolicyKind::linear || policy.kind == PolicyKind::nwa),
      relighter_(relighter),
      column_cost_(count_column_costs(bake.column_bytes(), relighter.tile_count())),
      largest_column_cost_(*std::ranges::max_element(column_cost_)) {}

void FrameUpdater::plan(const CubeLight& target, const Budget& budget,
                        std::span<const std::uint32_t> column_bytes) {
  policy_->make_plan({.basis = basis_,
                      .target = target,
                      .held = relighter_.held(),
                      .budget = budget,
                      .column_norm_squared = bake_.sketch().norm_squared,
                      .column_bytes = column_bytes,
                      .band_image_bytes = band_image_bytes()},
                     workspace_, plan_);
}

std::size_t FrameUpdater::band_image_bytes() const {
  return relighter_.tile_count() * kTileFloats * sizeof(float);
}

std::size_t FrameUpdater::planned_cost() const {
  std::size_t cost = 0;
  for (const ColumnDelta& column : plan_.columns) cost += column_cost_[column.column];
  for (const BandUpdate& band : plan_.bands) {
    if (band.action == BandAction::reset && band.count > 0) cost += band_image_bytes();
  }
  return cost;
}

bool FrameUpdater::apply_batch(const CubeLight& target, const Budget& budget,
                               std::span<const std::uint32_t> column_bytes, UpdateReport& report) {
  Stopwatch watch;
  plan(target, budget, column_bytes);
  report.plan_ms += watch.elapsed_ms();
  const std::size_t resets = static_cast<std::size_t>(
      std::ranges::count(plan_.bands, BandAction::reset, &BandUpdate::action));
  if (plan_.columns.empty() && resets == 0) return false;
  for (std::size_t band = 0; band < plan_.bands.size(); ++band) {
    report.reset_bands |= std::uint32_t{plan_.bands[band].action == BandAction::reset} << band;
  }
  watch.lap_ms();
  relighter_.apply(plan_, target);
  const double taken = watch.lap_ms();
  cost_.learn(planned_cost(), taken);
  report.apply_ms += taken;
  report.columns += plan_.columns.size();
  for (const ColumnDelta& column : plan_.columns) {
    report.bytes += bake_.column_bytes()[column.column];
  }
  report.bands_reset += resets;
  report.tiles_rebuilt += relighter_.tiles_rebuilt();
  return !plan_.columns.empty();
}

void FrameUpdater::update_until(const CubeLight& target, double deadline_ms, UpdateReport& report) {
  const Stopwatch watch;
  // A second batch of a policy that keeps nothing would undo the first.
  const int most_batches = keeps_nothing_ ? 1 : kMostBatches;
  for (int batch = 0; batch < most_batches; ++batch) {
    const double left = deadline_ms - watch.elapsed_ms();
    if (batch > 0 && left < kShortestBatchMs) return;
    const double share = batch == 0 && !keeps_nothing_ ? kFirstShare : kNextShare;
    std::size_t cost = cost_.bytes_within(share * left);
    // However short the time, a column fits: else the image would stay as it is for ever.
    if (batch == 0) cost = std::max(cost, largest_column_cost_);
    if (!apply_batch(target, Budget::bytes(cost), column_cost_, report)) return;
  }
}

UpdateReport FrameUpdater::update(const CubeLight& target, const FrameBudget& budget) {
  UpdateReport report;
  const auto amount = static_cast<std::size_t>(std::max(0.0, budget.amount));
  switch (budget.unit) {
    case FrameBudget::Unit::coefficients:
      apply_batch(target, Budget::coefficients(amount), bake_.column_bytes(), report);
      break;
    case FrameBudget::Unit::bytes:
      apply_batch(target, Budget::bytes(amount), bake_.column_bytes(), report);
      break;
    case FrameBudget::Unit::milliseconds:
      update_until(target, budget.amount, report);
      break;
  }
  return report;
}

}  // namespace rimlight
