#include "server/schedule/overload.h"

#include <algorithm>
#include <cmath>

namespace rimlight::server {
namespace {

using Milliseconds = std::chrono::duration<double, std::milli>;

constexpr Milliseconds kRecent{500}, kLasting{2000};
/// The first job of all counts as if it came so long after another.
constexpr Milliseconds kFirstGap{10};

/// An exponential mean over time: what came `gap` after the last sample weighs by that.
void add(std::atomic<double>& mean, double sample, Milliseconds gap, Milliseconds over) {
  const double weight = -std::expm1(-gap / over);
  const double old = mean.load(std::memory_order_relaxed);
  mean.store(old + weight * (sample - old), std::memory_order_relaxed);
}

}  // namespace

bool Overload::is_quiet(Clock::time_point now) const {
  const auto last = last_.load(std::memory_order_relaxed);
  return last == 0 || now - Clock::time_point(Clock::duration(last)) >= kLasting;
}

void Overload::begin(Clock::time_point due, Clock::time_point now) {
  const double late = std::max(0.0, Milliseconds(now - due).count());
  const auto last = last_.exchange(now.time_since_epoch().count(), std::memory_order_relaxed);
  const Milliseconds gap =
      last == 0 ? kFirstGap : Milliseconds(now.time_since_epoch() - Clock::duration(last));
  // Jobs that begin at one time weigh a little too: else a burst of them would not count.
  const Milliseconds weighed = std::max(gap, Milliseconds(1));
  add(recent_ms_, late, weighed, kRecent);
  add(lasting_ms_, late, weighed, kLasting);
  const double lasting = lasting_ms_.load(std::memory_order_relaxed);
  const Stage before = stage_.load(std::memory_order_relaxed);
  const auto reached = [&](Stage stage, std::chrono::milliseconds bound) {
    const double from = static_cast<double>(bound.count());
    return lasting >= (before >= stage ? from / 2 : from);
  };
  Stage stage = Stage::none;
  if (reached(Stage::no_new_sessions, settings_.refusing)) stage = Stage::no_new_sessions;
  if (reached(Stage::editors_first, settings_.shedding)) stage = Stage::editors_first;
  stage_.store(stage, std::memory_order_relaxed);
}

double Overload::budget_share(Clock::time_point now) const {
  if (is_quiet(now)) return 1;
  const double late = recent_ms_.load(std::memory_order_relaxed);
  const auto comfortable = static_cast<double>(settings_.comfortable.count());
  return late <= comfortable ? 1 : std::max(settings_.least_share, comfortable / late);
}

Overload::Stage Overload::stage(Clock::time_point now) const {
  if (is_quiet(now)) return Stage::none;
  const Stage stage = stage_.load(std::memory_order_relaxed);
  if (stage != Stage::none) return stage;
  return budget_share(now) < 1 ? Stage::smaller_budgets : Stage::none;
}

}  // namespace rimlight::server
