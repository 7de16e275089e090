#include "core/report/run_summary.h"

#include <algorithm>
#include <utility>

namespace rimlight {
namespace {

/// Whether it is one of the still frames after a motion, and not before the first.
bool is_after_motion(const FrameRow& row, bool has_moved) { return !row.moving && has_moved; }

/// The upper one of an even number.
double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

RunSummary summarize(const FrameRow* begin, const FrameRow* end) {
  RunSummary summary{begin->light, begin->run, begin->policy, begin->budget, {}, {}, {}};
  std::vector<const FrameRow*> moving, still, just_after;
  for (const FrameRow* row = begin; row != end; ++row) {
    if (row->moving) moving.push_back(row);
    if (!is_after_motion(*row, !moving.empty())) continue;
    still.push_back(row);
    if (row->frames_since_edit == kJustAfter) just_after.push_back(row);
  }
  summary.moving = mean_of(moving);
  summary.still = mean_of(still);
  summary.just_after = mean_of(just_after);
  return summary;
}

}  // namespace

FrameMeans mean_of(const std::vector<const FrameRow*>& frames) {
  FrameMeans means;
  if (frames.empty()) return means;
  means.frames = frames.size();
  const double share = 1 / static_cast<double>(frames.size());
  std::vector<double> ms, bytes;
  for (const FrameRow* const row : frames) {
    ms.push_back(row->ms.total());
    bytes.push_back(static_cast<double>(row->bytes));
    means.relative_l2 += share * row->relative_l2;
    means.psnr_db += share * row->psnr_db;
    means.psnr_time_db += share * row->psnr_time_db;
    means.lighting_error += share * row->lighting_error;
    means.ghost += share * row->ghost;
  }
  means.median_ms = median(std::move(ms));
  means.median_bytes = median(std::move(bytes));
  return means;
}

std::vector<const FrameRow*> frames_that_count(const std::vector<FrameRow>& rows) {
  const bool any_moves = std::ranges::any_of(rows, &FrameRow::moving);
  std::vector<const FrameRow*> frames;
  for (const FrameRow& row : rows) {
    if (row.moving || !any_moves) frames.push_back(&row);
  }
  return frames;
}

std::vector<RunSummary> summarize_runs(const std::vector<FrameRow>& rows) {
  std::vector<RunSummary> summaries;
  const FrameRow* const end = rows.data() + rows.size();
  for (const FrameRow* begin = rows.data(); begin != end;) {
    const FrameRow* const next = std::find_if(begin, end, [&](const FrameRow& row) {
      return row.light != begin->light || row.run != begin->run;
    });
    summaries.push_back(summarize(begin, next));
    begin = next;
  }
  return summaries;
}

}  // namespace rimlight
