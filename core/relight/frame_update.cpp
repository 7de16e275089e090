#include "core/relight/frame_update.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/error.h"
#include "core/base/stopwatch.h"

namespace rimlight {
namespace {

/// A batch is planned for this share of the time that is left: what it then takes tells how much
/// more there is.
constexpr double kShare = 0.9;
constexpr int kMostBatches = 4;
/// Time too short for another batch.
constexpr double kShortestBatchMs = 0.3;

/// What the cost model counts. Adding a block takes about the same time however wide it is; looking
/// for a column in a tile, as much as a dozen blocks, since its offset is seldom in a cache; and
/// finding the blocks of a run, some more. (Measured on layers of a few hundred columns of every
/// band of the default scene: their time by this count is the same to a quarter.)
constexpr std::uint64_t kWorkPerBlock = 8;
constexpr std::uint64_t kWorkPerRun = 150;
constexpr std::uint64_t kWorkPerTile = 100;

std::uint32_t clamped(std::uint64_t amount) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
  return static_cast<std::uint32_t>(std::min(kMost, amount));
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
      bytes_(count_bytes(bake)),
      work_(count_work(bake)),
      most_work_of_a_column_(*std::ranges::max_element(work_.column)),
      work_of_a_tile_(std::accumulate(work_.column.begin(), work_.column.end(), 0.0) /
                      static_cast<double>(relighter.tile_count())) {}

std::uint64_t FrameUpdater::Costs::of(const ColumnDelta& delta) const {
  if (delta.layers == kAllLayers) return column[delta.column];
  std::uint64_t cost = 0;
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    if ((delta.layers >> layer & 1) != 0) cost += part[part_of(delta.column, layer)];
  }
  return cost;
}

FrameUpdater::Costs FrameUpdater::count_bytes(const Bake& bake) {
  Costs costs{bake.column_bytes(), {}};
  for (const PartSize& size : bake.part_sizes()) costs.part.push_back(size.bytes);
  return costs;
}

FrameUpdater::Costs FrameUpdater::count_work(const Bake& bake) {
  Costs costs;
  const auto& sizes = bake.part_sizes();
  const std::uint64_t lookups = bake.transport().tile_count() * kWorkPerTile;
  for (std::size_t column = 0; column < bake.column_bytes().size(); ++column) {
    std::uint64_t blocks = 0, runs = 0;
    for (std::size_t layer = 0; layer < kLayers; ++layer) {
      const PartSize& size = sizes[part_of(column, layer)];
      const std::uint64_t work = size.blocks * kWorkPerBlock + size.runs * kWorkPerRun + lookups;
      costs.part.push_back(size.blocks == 0 ? 0 : clamped(work));
      blocks += size.blocks;
      runs = std::max<std::uint64_t>(runs, size.runs);
    }
    costs.column.push_back(clamped(blocks * kWorkPerBlock + runs * kWorkPerRun + lookups));
  }
  return costs;
}

void FrameUpdater::plan(const CubeLight& target, const Budget& budget, const Costs& costs) {
  policy_->make_plan({.basis = basis_,
                      .target = target,
                      .held = relighter_.held(),
                      .budget = budget,
                      .column_norm_squared = bake_.sketch().norm_squared,
                      .column_bytes = costs.column,
                      .band_image_bytes = band_image_bytes(),
                      .one_image = !relighter_.holds_bands(),
                      .part_norm_squared = bake_.sketch().part_norm_squared,
                      .part_bytes = costs.part},
                     workspace_, plan_);
}

std::size_t FrameUpdater::band_image_bytes() const {
  return relighter_.tile_count() * kTileFloats * sizeof(float);
}

std::size_t FrameUpdater::work_done() const {
  std::size_t work = 0;
  for (const ColumnDelta& column : plan_.columns) work += work_.of(column);
  std::size_t cleared = 0;
  for (const BandUpdate& band : plan_.bands) {
    cleared += band.action == BandAction::reset && band.count > 0;
  }
  work +=
      band_image_bytes() * (relighter_.holds_bands() ? cleared : std::min<std::size_t>(cleared, 1));
  return work + static_cast<std::size_t>(static_cast<double>(relighter_.tiles_rebuilt()) *
                                         work_of_a_tile_);
}

bool FrameUpdater::apply_batch(const CubeLight& target, const Budget& budget, const Costs& costs,
                               UpdateReport& report) {
  Stopwatch watch;
  plan(target, budget, costs);
  const double planning = watch.lap_ms();
  planning_.add(planning);
  report.plan_ms += planning;
  const std::size_t resets = static_cast<std::size_t>(
      std::ranges::count(plan_.bands, BandAction::reset, &BandUpdate::action));
  if (plan_.columns.empty() && resets == 0) return false;
  for (std::size_t band = 0; band < plan_.bands.size(); ++band) {
    report.reset_bands |= std::uint32_t{plan_.bands[band].action == BandAction::reset} << band;
  }
  watch.lap_ms();
  relighter_.apply(plan_, target);
  const double taken = watch.lap_ms();
  cost_.learn(work_done(), taken);
  constexpr double kNewest = 0.2;
  rebuilding_ +=
      kNewest * (static_cast<double>(relighter_.tiles_rebuilt()) * work_of_a_tile_ - rebuilding_);
  report.apply_ms += taken;
  report.columns += plan_.column_count();
  for (const ColumnDelta& column : plan_.columns) report.bytes += bytes_.of(column);
  report.bands_reset += resets;
  report.tiles_rebuilt += relighter_.tiles_rebuilt();
  return !plan_.columns.empty();
}

void FrameUpdater::update_until(const CubeLight& target, double deadline_ms, UpdateReport& report) {
  const Stopwatch watch;
  // A second batch of a policy that keeps nothing would undo the first.
  const int most_batches = keeps_nothing_ ? 1 : kMostBatches;
  for (int batch = 0; batch < most_batches; ++batch) {
    const double left = deadline_ms - watch.elapsed_ms() - planning_.typical_ms();
    if (batch > 0 && left < kShortestBatchMs) return;
    const auto all = static_cast<double>(cost_.work_within(kShare * left));
    auto work = static_cast<std::size_t>(std::max(0.0, all - rebuilding_));
    // However short the time, a column fits: else the image would stay as it is for ever.
    if (batch == 0) work = std::max(work, most_work_of_a_column_);
    if (!apply_batch(target, Budget::bytes(work), work_, report)) return;
  }
}

UpdateReport FrameUpdater::update(const CubeLight& target, const FrameBudget& budget) {
  UpdateReport report;
  const auto amount = static_cast<std::size_t>(std::max(0.0, budget.amount));
  switch (budget.unit) {
    case FrameBudget::Unit::coefficients:
      apply_batch(target, Budget::coefficients(amount), bytes_, report);
      break;
    case FrameBudget::Unit::bytes:
      apply_batch(target, Budget::bytes(amount), bytes_, report);
      break;
    case FrameBudget::Unit::milliseconds:
      update_until(target, budget.amount, report);
      break;
  }
  return report;
}

}  // namespace rimlight
