#include "server/delivery/delay_meter.h"

#include <algorithm>
#include <bit>

namespace rimlight::server {
namespace {

/// Sizes nearer to each other than this say too little of what a byte takes.
constexpr double kLeastRatio = 2;

}  // namespace

double DelayMeter::record(std::size_t bytes, double delay_ms, Clock::time_point now) {
  if (now - current_since_ >= kEpoch) {
    // After a long silence nothing of before says much of now, but it is all there is.
    before_ = current_;
    current_ = {};
    current_since_ = now;
  }
  const auto size_class = std::min<std::size_t>(std::bit_width(bytes), kClasses - 1);
  current_[size_class].take({delay_ms, static_cast<double>(bytes)});
  estimate();
  return std::max(0.0, delay_ms - base_ms_);
}

void DelayMeter::estimate() {
  Epoch least = before_;
  for (std::size_t i = 0; i < kClasses; ++i) least[i].take(current_[i]);
  const auto is_seen = [](const Least& entry) { return entry.delay_ms < kNone; };
  const auto smallest = std::find_if(least.begin(), least.end(), is_seen);
  const auto largest = std::find_if(least.rbegin(), least.rend(), is_seen);
  if (largest->bytes >= kLeastRatio * smallest->bytes && largest->bytes > 0) {
    ms_per_byte_ = std::max(
        0.0, (largest->delay_ms - smallest->delay_ms) / (largest->bytes - smallest->bytes));
  }
  double base = kNone;
  for (const Least& entry : least) {
    if (is_seen(entry)) base = std::min(base, entry.delay_ms - ms_per_byte_ * entry.bytes);
  }
  base_ms_ = std::max(0.0, base);
}

}  // namespace rimlight::server
