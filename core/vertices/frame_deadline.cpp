#include "core/vertices/frame_deadline.h"

#include "core/transport/receivers.h"

namespace rimlight {
namespace {

/// Plans are made for this share of the deadline: parts take now more, now less.
constexpr double kPlanned = 0.95;
/// A finer rate than the last frame's has to be so much faster than it must be, else frames would
/// go to and fro.
constexpr double kSlack = 0.9;
/// Fewer vertices tell nothing: they wake the threads and little more.
constexpr std::size_t kLeastVertices = 512;
/// The clock tells how fast tiles go from this share of them on.
constexpr std::int64_t kToldAfter = 8;

/// Work of a tile: a pixel 1, a highlight that is evaluated as much as 10 of them. (Measured at
/// degree 10.)
constexpr std::int64_t kPerHighlight = 10;

std::int64_t tile_work(const HighlightPlan& plan, std::size_t tile, HighlightRate rate) {
  constexpr auto kPixels = static_cast<std::int64_t>(kTileReceivers);
  return kPixels + kPerHighlight * static_cast<std::int64_t>(plan.evaluated(rate, tile));
}

std::int64_t whole_work(const HighlightPlan& plan, HighlightRate rate) {
  std::int64_t sum = 0;
  for (std::size_t tile = 0; tile < plan.tile_count(); ++tile) sum += tile_work(plan, tile, rate);
  return sum;
}

HighlightRate coarser(HighlightRate rate) {
  return rate == HighlightRate::every ? HighlightRate::quarter : HighlightRate::sixteenth;
}

}  // namespace

FrameDeadline::FrameDeadline(const FrameBudget& budget, double view_ms)
    : budget_(budget), view_ms_(view_ms) {}

void FrameDeadline::start() {
  watch_.lap_ms();
  traced_ = GBufferDetail::none;
}

double FrameDeadline::least_rest_ms() const {
  return light_ms(least_vertices_) + of_work_.typical_ms() * static_cast<double>(least_work_);
}

GBufferDetail FrameDeadline::detail(GBufferDetail known) const {
  if (known != GBufferDetail::none) return GBufferDetail::full;
  const double full_ms = views_.typical_ms();
  const bool fits = is_kept() ? elapsed_ms() + hope_ * (full_ms + least_rest_ms()) <= budget_.amount
                              : view_ms_ > 0 && full_ms <= view_ms_;
  return fits ? GBufferDetail::full : GBufferDetail::coarse;
}

void FrameDeadline::looked(GBufferDetail known, GBufferDetail detail, double ms) {
  constexpr double kLess = 0.98;
  if (known != GBufferDetail::none) return;
  traced_ = detail;
  if (detail == GBufferDetail::full) views_.add(ms);
  hope_ = detail == GBufferDetail::full ? 1 : hope_ * kLess;
}

double FrameDeadline::light_ms(std::size_t vertices) const {
  return of_vertex_.typical_ms() * static_cast<double>(vertices);
}

HighlightRate FrameDeadline::choose_rate(const HighlightPlan& plan,
                                         const std::array<std::size_t, kHighlightRates>& missing) {
  if (!is_kept()) return HighlightRate::every;
  if (traced_ != GBufferDetail::none) {
    least_vertices_ = missing[index_of(HighlightRate::sixteenth)];
  }
  if (traced_ == GBufferDetail::full) {
    least_work_ = whole_work(plan, HighlightRate::sixteenth);
  }
  const double left = kPlanned * budget_.amount - elapsed_ms();
  for (const HighlightRate rate : {HighlightRate::every, HighlightRate::quarter}) {
    const double needed = light_ms(missing[index_of(rate)]) +
                          of_work_.typical_ms() * static_cast<double>(whole_work(plan, rate));
    if (needed <= (rate < last_rate_ ? kSlack * left : left)) return rate;
  }
  return HighlightRate::sixteenth;
}

void FrameDeadline::lit(std::size_t vertices, double ms) {
  if (vertices >= kLeastVertices) of_vertex_.add(ms / static_cast<double>(vertices));
}

void FrameDeadline::start_tiles(const HighlightPlan& plan, HighlightRate rate) {
  plan_ = &plan;
  done_.store(0);
  for (const HighlightRate one :
       {HighlightRate::every, HighlightRate::quarter, HighlightRate::sixteenth}) {
    left_[index_of(one)].store(whole_work(plan, one));
  }
  tiles_at_ms_ = elapsed_ms();
  rate_.store(rate);
}

HighlightRate FrameDeadline::rate_of_tile() {
  HighlightRate rate = rate_.load();
  const HighlightRate before = rate;
  const double now = elapsed_ms();
  const std::int64_t done = done_.load();
  const bool is_told = done * kToldAfter >= done + left_[index_of(rate)].load() && done > 0;
  const double pace =
      is_told ? (now - tiles_at_ms_) / static_cast<double>(done) : of_work_.typical_ms();
  while (rate != HighlightRate::sixteenth &&
         now + pace * static_cast<double>(left_[index_of(rate)].load()) > budget_.amount) {
    rate = coarser(rate);
  }
  if (rate > before) {
    HighlightRate known = before;
    while (known < rate && !rate_.compare_exchange_weak(known, rate)) {
    }
  }
  return rate;
}

void FrameDeadline::finish_tile(std::size_t tile, HighlightRate rate) {
  done_ += tile_work(*plan_, tile, rate);
  for (const HighlightRate one :
       {HighlightRate::every, HighlightRate::quarter, HighlightRate::sixteenth}) {
    left_[index_of(one)] -= tile_work(*plan_, tile, one);
  }
}

void FrameDeadline::finish() {
  const double now = elapsed_ms();
  last_rate_ = rate_.load();
  if (done_.load() > 0) of_work_.add((now - tiles_at_ms_) / static_cast<double>(done_.load()));
}

}  // namespace rimlight
