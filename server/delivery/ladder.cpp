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

void LadderClimber::expect(double ms_per_byte, double share) {
  const auto expected_ms = [&] { return kRungs[rung_].kilobytes * 1000 * share * ms_per_byte; };
  while (samples_ == 0 && !risen_ && rung_ + 1 < range_.end &&
         expected_ms() > kFarOver * kMostQueueMs) {
    move_to(rung_ + 1, {});
  }
}

void PartSizer::record(std::size_t bytes, double delay_ms, double queue_ms, double ms_per_byte) {
  constexpr double kMost = LadderClimber::kMostQueueMs;
  const auto sent = static_cast<double>(bytes);
  auto size = static_cast<double>(bytes_);
  if (queue_ms > kMost) {
    size = std::min(size, sent * kMost / queue_ms);
  } else if (delay_ms > 0) {
    // The whole delay says what surely passes; where that is mostly the way there and back, twice
    // as many bytes tell the two apart.
    size = std::max(size, sent * std::clamp(kMost / delay_ms, 2.0, 4.0));
  }
  if (ms_per_byte > 0) size = std::min(size, kMost / ms_per_byte);
  bytes_ = static_cast<std::size_t>(
      std::clamp(size, static_cast<double>(kSmallest), static_cast<double>(kLargest)));
}

std::size_t preview_rung(std::size_t part_bytes, std::size_t first, int width, int height) {
  const double share = static_cast<double>(width) * height / (512.0 * 512.0);
  std::size_t rung = std::max(first, kVp8Rungs);
  const auto expected = [&] { return kRungs[rung].kilobytes * 1000 * share; };
  while (rung + 1 < kRungs.size() && expected() > static_cast<double>(part_bytes)) ++rung;
  return rung;
}

}  // namespace rimlight::server
