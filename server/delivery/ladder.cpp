#include "server/delivery/ladder.h"

#include <algorithm>

#include "core/image/picture_scaler.h"

namespace rimlight::server {
namespace {

using std::chrono::milliseconds;

constexpr double kSmoothing = 0.25;  // the weight of the newest
constexpr double kFarOver = 2;       // times the bound
constexpr double kWellWithin = 0.6;  // of the bound, after a step up
constexpr int kLeastSamples = 2;     // before a smoothed delay counts
constexpr milliseconds kShortest{2000}, kLongest{60'000};
constexpr milliseconds kSoon{5000};  // a step up that is taken back within this was wrong

std::int64_t pixels_of(const Rung& rung, int width, int height) {
  return std::int64_t{divided_side(width, rung.divisor)} * divided_side(height, rung.divisor);
}

}  // namespace

RungRange rungs_for(const Display& display, int width, int height) {
  const auto first_small_enough = [&](std::size_t begin, std::size_t end) {
    std::size_t i = begin;
    while (i < end && display.most_pixels > 0 &&
           pixels_of(kRungs[i], width, height) > display.most_pixels) {
      ++i;
    }
    return i;
  };
  if (display.vp8) {
    const std::size_t first = first_small_enough(0, kVp8Rungs);
    if (first < kVp8Rungs) return {first, kVp8Rungs};
  }
  // The smallest there is, where even that is too large.
  const std::size_t first = first_small_enough(kVp8Rungs, kRungs.size());
  return {std::min(first, kRungs.size() - 1), kRungs.size()};
}

void LadderClimber::set_range(RungRange range) {
  if (range == range_) return;
  const bool is_same_codec = range.end == range_.end;
  range_ = range;
  const std::size_t rung = is_same_codec ? std::max(rung_, range.first) : range.first;
  if (rung != rung_) move_to(rung, {});
}

void LadderClimber::move_to(std::size_t rung, Clock::time_point now) {
  risen_.reset();
  if (rung < rung_) risen_ = now;
  rung_ = rung;
  samples_ = 0;
  far_over_ = 0;
  calm_since_.reset();
}

void LadderClimber::record(std::size_t rung, double queue_ms, Clock::time_point now) {
  if (rung != rung_) return;  // sent before the last step
  smoothed_ms_ = samples_ == 0 ? queue_ms : smoothed_ms_ + kSmoothing * (queue_ms - smoothed_ms_);
  ++samples_;
  far_over_ = queue_ms > kFarOver * kMostQueueMs ? far_over_ + 1 : 0;
  if (risen_ && now - *risen_ >= kSoon) {
    patience_ = std::max(kShortest, patience_ / 2);  // the step up was right
    risen_.reset();
  }
  const bool is_over = samples_ >= kLeastSamples && smoothed_ms_ > kMostQueueMs;
  if (is_over || far_over_ >= kLeastSamples) {
    if (risen_) patience_ = std::min(kLongest, patience_ * 2);
    if (rung_ + 1 < range_.end) move_to(rung_ + 1, now);
    return;
  }
  if (rung_ == range_.first) return;
  const double expected = smoothed_ms_ * kRungs[rung_ - 1].kilobytes / kRungs[rung_].kilobytes;
  if (samples_ < kLeastSamples || expected > kWellWithin * kMostQueueMs) {
    calm_since_.reset();
  } else if (!calm_since_) {
    calm_since_ = now;
  } else if (now - *calm_since_ >= patience_) {
    move_to(rung_ - 1, now);
  }
}

std::size_t part_bytes(double ms_per_byte) {
  if (!(ms_per_byte > 0)) return kUnknownPart;
  const double fitting = LadderClimber::kMostQueueMs / ms_per_byte;
  return static_cast<std::size_t>(
      std::clamp(fitting, static_cast<double>(kSmallestPart), static_cast<double>(kLargestPart)));
}

}  // namespace rimlight::server
