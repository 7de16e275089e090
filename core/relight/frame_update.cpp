#include "core/relight/frame_update.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>

#include "core/base/error.h"

namespace rimlight {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Of a deadline's time the first batch is planned for this share: what it then takes tells how
/// much more there is.
constexpr double kFirstShare = 0.75;
constexpr double kNextShare = 0.9;
constexpr int kMostBatches = 4;
/// Time too short for another batch: planning alone takes a good part of it.
constexpr double kShortestBatchMs = 0.6;
/// Looking up a run costs about as much as reading this.
constexpr std::size_t kBytesPerRun = 64;

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

FrameUpdater::FrameUpdater(const Bake& bake, const CubeHaar& basis, const PolicySettings& policy,
                           Relighter& relighter)
    : bake_(bake), basis_(basis), policy_(make_policy(policy)), relighter_(relighter) {}

void FrameUpdater::plan(const CubeLight& target, const Budget& budget) {
  policy_->make_plan({.basis = basis_,
                      .target = target,
                      .held = relighter_.held(),
                      .budget = budget,
                      .column_norm_squared = bake_.sketch().norm_squared,
                      .column_bytes = bake_.column_bytes(),
                      .band_image_bytes = relighter_.tile_count() * kTileFloats * sizeof(float)},
                     workspace_, plan_);
}

std::size_t FrameUpdater::planned_bytes() const {
  std::size_t bytes = plan_.columns.size() * relighter_.tile_count() * kBytesPerRun;
  for (const ColumnDelta& column : plan_.columns) bytes += bake_.column_bytes()[column.column];
  return bytes;
}

bool FrameUpdater::apply_batch(const CubeLight& target, const Budget& budget,
                               UpdateReport& report) {
  const auto start = Clock::now();
  plan(target, budget);
  report.plan_ms += milliseconds_since(start);
  const std::size_t resets = static_cast<std::size_t>(
      std::ranges::count(plan_.bands, BandAction::reset, &BandUpdate::action));
  if (plan_.columns.empty() && resets == 0) return false;
  for (std::size_t band = 0; band < plan_.bands.size(); ++band) {
    report.reset_bands |= std::uint32_t{plan_.bands[band].action == BandAction::reset} << band;
  }
  const auto planned = Clock::now();
  relighter_.apply(plan_, target);
  const double taken = milliseconds_since(planned);
  const std::size_t bytes = planned_bytes();
  cost_.learn(bytes, taken);
  report.apply_ms += taken;
  report.columns += plan_.columns.size();
  report.bytes += bytes;
  report.bands_reset += resets;
  return !plan_.columns.empty();
}

void FrameUpdater::update_until(const CubeLight& target, double deadline_ms, UpdateReport& report) {
  const auto start = Clock::now();
  for (int batch = 0; batch < kMostBatches; ++batch) {
    const double left = deadline_ms - milliseconds_since(start);
    if (batch > 0 && left < kShortestBatchMs) return;
    const double share = batch == 0 ? kFirstShare : kNextShare;
    const std::size_t bytes = cost_.bytes_within(share * left);
    if (!apply_batch(target, Budget::bytes(bytes), report)) return;
  }
}

UpdateReport FrameUpdater::update(const CubeLight& target, const FrameBudget& budget) {
  UpdateReport report;
  const auto amount = static_cast<std::size_t>(std::max(0.0, budget.amount));
  switch (budget.unit) {
    case FrameBudget::Unit::coefficients:
      apply_batch(target, Budget::coefficients(amount), report);
      break;
    case FrameBudget::Unit::bytes:
      apply_batch(target, Budget::bytes(amount), report);
      break;
    case FrameBudget::Unit::milliseconds:
      update_until(target, budget.amount, report);
      break;
  }
  report.tiles_rebuilt = relighter_.tiles_rebuilt();
  return report;
}

}  // namespace rimlight
