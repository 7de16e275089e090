#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "core/base/stopwatch.h"
#include "core/relight/frame_update.h"
#include "core/relight/recent_times.h"
#include "core/scene/g_buffer.h"
#include "core/vertices/highlight_rate.h"

namespace rimlight {

/// Keeps the deadline of moving frames of vertices: chooses how much of a new view is traced and at
/// how many pixels highlights are evaluated, from what parts of frames took lately (RecentTimes)
/// and how much of each there is to do; while tiles are shaded it looks at the clock, and sends the
/// later ones to a coarser rate when the frame is late. Only a budget in milliseconds is one; under
/// any other views follow `view_ms`, and highlights are evaluated at every pixel.
///
/// A frame is not shortened below matt light at every traced pixel, highlights at one pixel in
/// sixteen (and where those fit no neighbour), and the vertices that these need; a new view not
/// below every fourth ray; and the frame after a coarse one of the same view traces the rest,
/// whatever that takes.
///
/// One thread at a time, but where said otherwise.
class FrameDeadline {
 public:
  FrameDeadline(const FrameBudget& budget, double view_ms);

  bool is_kept() const { return budget_.unit == FrameBudget::Unit::milliseconds; }
  /// Of later frames.
  void set_budget(const FrameBudget& budget) { budget_ = budget; }
  /// A frame starts now.
  void start();
  double elapsed_ms() const { return watch_.elapsed_ms(); }

  /// What to trace of a view of which so much is known.
  GBufferDetail detail(GBufferDetail known) const;
  /// It took so long to trace `detail` where `known` was.
  void looked(GBufferDetail known, GBufferDetail detail, double ms);

  /// At which rate highlights can be evaluated in time, when so many vertices' light is missing
  /// for each.
  HighlightRate choose_rate(const HighlightPlan& plan,
                            const std::array<std::size_t, kHighlightRates>& missing);
  /// The light of so many vertices took so long.
  void lit(std::size_t vertices, double ms);

  /// Tiles are shaded from now on, at this rate or coarser ones. The plan outlives the frame.
  void start_tiles(const HighlightPlan& plan, HighlightRate rate);
  /// The rate of a tile that starts now. Any thread.
  HighlightRate rate_of_tile();
  /// It is done. Any thread.
  void finish_tile(std::size_t tile, HighlightRate rate);
  /// The frame's pixels are there.
  void finish();

 private:
  double light_ms(std::size_t vertices) const;
  double least_rest_ms() const;

  FrameBudget budget_;
  double view_ms_;
  Stopwatch watch_;
  RecentTimes views_;                           // full ones, traced from nothing
  GBufferDetail traced_ = GBufferDetail::none;  // from nothing, in this frame
  // What the rest of a new full view's frame is made of at the coarsest rate, lately.
  std::size_t least_vertices_ = 0;
  std::int64_t least_work_ = 0;
  /// A view that once took long is not believed to for ever: each coarse one makes it less.
  double hope_ = 1;
  RecentTimes of_vertex_;  // milliseconds
  RecentTimes of_work_;    // milliseconds
  const HighlightPlan* plan_ = nullptr;
  double tiles_at_ms_ = 0;
  std::atomic<HighlightRate> rate_{HighlightRate::every};
  HighlightRate last_rate_ = HighlightRate::every;
  // Work of tiles, as tile_work() counts it.
  std::atomic<std::int64_t> done_{0};
  std::array<std::atomic<std::int64_t>, kHighlightRates> left_{};
};

}  // namespace rimlight
