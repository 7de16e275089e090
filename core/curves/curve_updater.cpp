#include "core/curves/curve_updater.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/base/stopwatch.h"

namespace rimlight {
namespace {

constexpr std::size_t kColumnBytes = kPanelFloats * sizeof(std::int16_t);
constexpr std::size_t kImageBytes = kPanelFloats * sizeof(float);
/// A batch is planned for this share of the time that is left: what it then takes tells how much
/// more there is.
constexpr double kShare = 0.9;
constexpr int kMostBatches = 4;
/// Time too short for another batch.
constexpr double kShortestBatchMs = 0.3;

bool is_zero(const Vec3f& value) { return value == Vec3f{}; }

double size_of(const Vec3f& value) {
  return std::abs(double{value.x}) + std::abs(double{value.y}) + std::abs(double{value.z});
}

}  // namespace

CurveUpdater::CurveUpdater(const CurveTransport& transport, CurvePolicy policy)
    : transport_(transport),
      policy_(policy),
      shown_(transport.material_count()),
      image_(transport.panels().size() * kPanelFloats),
      fresh_(image_.size()) {
  for (const CurvePanel& panel : transport.panels()) {
    Shown& shown = shown_[panel.material];
    place_in_material_.push_back(shown.panel_count++);
    shown.column_bytes += kColumnBytes;
  }
  for (Shown& shown : shown_) shown.columns.reserve(kCurveBins);
  choices_.reserve(shown_.size() * kCurveBins);
}

bool CurveUpdater::Choice::goes_before(const Choice& other) const {
  if (gain != other.gain) return gain > other.gain;
  if (size != other.size) return size > other.size;
  if (material != other.material) return material < other.material;
  return coefficient < other.coefficient;
}

void CurveUpdater::make_fresh(std::size_t panel, const CurveCoefficients& curve,
                              float* image) const {
  std::ranges::copy(transport_.fixed(panel), image);
  const auto axis = shown_[transport_.panels()[panel].material].axis;
  if (!axis) return;
  std::array<CurveColumn, kCurveBins> columns;
  std::size_t count = 0;
  for (std::uint32_t k = 0; k < kCurveBins; ++k) {
    if (!is_zero(curve[k])) columns[count++] = {k, curve[k]};
  }
  add_curve_columns(transport_.numbers(panel, *axis).data(), transport_.steps(panel, *axis).data(),
                    std::span(columns).first(count), image);
}

void CurveUpdater::show(std::uint32_t material, std::optional<CurveAxis> axis,
                        const CurveCoefficients& held) {
  RIMLIGHT_CHECK(!axis || transport_.panels().empty() || !transport_.numbers(0, *axis).empty());
  Shown& shown = shown_[material];
  shown.axis = axis;
  shown.held = shown.target = axis ? held : CurveCoefficients{};
  shown.rebuild_credit = 0;
  parallel_for(transport_.panels().size(), [&](std::size_t panel) {
    if (transport_.panels()[panel].material == material) refresh(panel);
  });
}

void CurveUpdater::refresh(std::size_t panel) {
  make_fresh(panel, held(transport_.panels()[panel].material),
             image_.data() + panel * kPanelFloats);
}

void CurveUpdater::set_target(std::uint32_t material, const CurveCoefficients& target) {
  RIMLIGHT_CHECK(shown_[material].axis.has_value());
  for (const Vec3f& value : target) RIMLIGHT_CHECK(is_finite(value));
  shown_[material].target = target;
}

void CurveUpdater::list_choices() {
  choices_.clear();
  for (std::uint32_t m = 0; m < shown_.size(); ++m) {
    const Shown& shown = shown_[m];
    if (!shown.axis || is_at_target(m)) continue;
    for (std::uint32_t k = 0; k < kCurveBins; ++k) {
      const Vec3f delta =
          policy_ == CurvePolicy::nwa ? shown.target[k] : shown.target[k] - shown.held[k];
      if (is_zero(delta)) continue;
      const double size = size_of(delta);
      double gain = size;
      if (policy_ == CurvePolicy::benefit) {
        const Vec3d squared = Vec3d(delta) * Vec3d(delta);
        gain = dot(squared, transport_.column_norm_squared(m, *shown.axis, k));
      }
      choices_.push_back({gain, size, m, k});
    }
  }
  std::ranges::sort(choices_, [](const Choice& a, const Choice& b) { return a.goes_before(b); });
}

std::size_t CurveUpdater::choose(const FrameBudget& budget) {
  list_choices();
  for (std::uint32_t m = 0; m < shown_.size(); ++m) {
    shown_[m].columns.clear();
    shown_[m].starts_from_zero =
        policy_ == CurvePolicy::nwa && shown_[m].axis.has_value() && !is_at_target(m);
  }
  const bool counts_bytes = budget.unit == FrameBudget::Unit::bytes;
  double spent = 0;
  std::size_t bytes = 0;
  for (const Choice& choice : choices_) {
    Shown& shown = shown_[choice.material];
    const double cost = counts_bytes ? static_cast<double>(shown.column_bytes) : 1;
    if (!(spent + cost <= budget.amount)) continue;
    spent += cost;
    bytes += shown.column_bytes;
    const std::uint32_t k = choice.coefficient;
    const Vec3f from = shown.starts_from_zero ? Vec3f{} : shown.held[k];
    shown.columns.push_back({k, shown.target[k] - from});
  }
  for (Shown& shown : shown_) {
    std::ranges::sort(shown.columns, {}, &CurveColumn::coefficient);
  }
  return bytes;
}

void CurveUpdater::choose_rebuilt(Shown& shown) {
  shown.rebuilt = 0;
  if (shown.panel_count == 0) return;
  shown.rebuild_credit = std::min(shown.rebuild_credit + shown.columns.size() * shown.panel_count,
                                  kMostAdditions * shown.panel_count);
  shown.rebuilt = static_cast<std::uint32_t>(shown.rebuild_credit / kMostAdditions);
  shown.rebuild_credit -= shown.rebuilt * kMostAdditions;
}

bool CurveUpdater::is_rebuilt(const Shown& shown, std::uint32_t place) const {
  return (place + shown.panel_count - shown.next_rebuilt) % shown.panel_count < shown.rebuilt;
}

void CurveUpdater::apply_to(std::size_t panel, float* image) const {
  const Shown& shown = shown_[transport_.panels()[panel].material];
  if (!shown.axis) return;
  if (is_rebuilt(shown, place_in_material_[panel])) return make_fresh(panel, shown.held, image);
  if (shown.starts_from_zero) std::ranges::copy(transport_.fixed(panel), image);
  if (shown.columns.empty()) return;
  add_curve_columns(transport_.numbers(panel, *shown.axis).data(),
                    transport_.steps(panel, *shown.axis).data(), shown.columns, image);
}

void CurveUpdater::apply_choice(CurveUpdateReport& report) {
  for (Shown& shown : shown_) {
    if (shown.starts_from_zero) shown.held = {};
    // The target itself, not held + delta, which may round beside it.
    for (const CurveColumn& column : shown.columns) {
      shown.held[column.coefficient] = shown.target[column.coefficient];
    }
    choose_rebuilt(shown);
    report.columns += shown.columns.size();
    report.bytes += shown.columns.size() * shown.column_bytes;
    report.panels_rebuilt += shown.rebuilt;
  }
  parallel_for(transport_.panels().size(),
               [&](std::size_t panel) { apply_to(panel, image_.data() + panel * kPanelFloats); });
  for (Shown& shown : shown_) {
    if (shown.rebuilt > 0) {
      shown.next_rebuilt = (shown.next_rebuilt + shown.rebuilt) % shown.panel_count;
    }
  }
}

bool CurveUpdater::apply_batch(const FrameBudget& budget, CurveUpdateReport& report) {
  Stopwatch watch;
  std::size_t work = choose(budget);
  report.plan_ms += watch.lap_ms();
  if (choices_.empty() && std::ranges::none_of(shown_, &Shown::starts_from_zero)) return false;
  const std::size_t before = report.columns;
  apply_choice(report);
  const double taken = watch.lap_ms();
  report.apply_ms += taken;
  for (const Shown& shown : shown_) {
    if (!shown.columns.empty()) work += 2 * kImageBytes * shown.panel_count;
    work += shown.rebuilt * kCurveBins * kColumnBytes;
  }
  cost_.learn(work, taken);
  return report.columns > before;
}

void CurveUpdater::update_until(double deadline_ms, CurveUpdateReport& report) {
  const Stopwatch watch;
  std::size_t largest = 1;  // at least one column goes
  for (const Shown& shown : shown_) largest = std::max(largest, shown.column_bytes);
  // A second batch of a policy that keeps nothing would undo the first.
  const int most_batches = policy_ == CurvePolicy::nwa ? 1 : kMostBatches;
  for (int batch = 0; batch < most_batches; ++batch) {
    const double left = deadline_ms - watch.elapsed_ms();
    if (batch > 0 && left < kShortestBatchMs) return;
    const std::size_t image = 2 * kImageBytes * transport_.panels().size();
    const std::size_t within = cost_.work_within(kShare * left);
    const std::size_t work =
        std::max(within > image ? within - image : 0, batch == 0 ? largest : 0);
    const FrameBudget bytes{FrameBudget::Unit::bytes, static_cast<double>(work)};
    if (!apply_batch(bytes, report)) return;
  }
}

CurveUpdateReport CurveUpdater::update(const FrameBudget& budget) {
  CurveUpdateReport report;
  if (budget.unit == FrameBudget::Unit::milliseconds) {
    update_until(budget.amount, report);
  } else {
    apply_batch(budget, report);
  }
  return report;
}

bool CurveUpdater::apply_exact(const std::function<bool()>& abandon) {
  std::atomic<bool> abandoned = false;
  parallel_for(transport_.panels().size(), [&](std::size_t panel) {
    if (abandoned.load(std::memory_order_relaxed)) return;
    if (abandon && abandon()) {
      abandoned.store(true, std::memory_order_relaxed);
      return;
    }
    make_fresh(panel, target(transport_.panels()[panel].material),
               fresh_.data() + panel * kPanelFloats);
  });
  if (abandoned) return false;
  image_.swap(fresh_);
  for (Shown& shown : shown_) {
    shown.held = shown.target;
    shown.rebuild_credit = 0;
  }
  return true;
}

double CurveUpdater::squared_error() const {
  double sum = 0;
  for (std::uint32_t m = 0; m < shown_.size(); ++m) {
    const Shown& shown = shown_[m];
    if (!shown.axis || is_at_target(m)) continue;
    CurveCoefficients residual;
    for (std::size_t k = 0; k < kCurveBins; ++k) residual[k] = shown.target[k] - shown.held[k];
    sum += transport_.squared_norm(m, *shown.axis, residual);
  }
  return sum;
}

std::span<const float> CurveUpdater::image(std::size_t panel) const {
  return std::span(image_).subspan(panel * kPanelFloats, kPanelFloats);
}

}  // namespace rimlight
