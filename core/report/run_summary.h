#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/report/frame_row.h"

namespace rimlight {

/// Means of some frames; the medians of what they cost. All 0 without frames.
struct FrameMeans {
  std::size_t frames = 0;
  double median_ms = 0;
  double median_bytes = 0;
  double relative_l2 = 0;
  double psnr_db = 0;
  double psnr_time_db = 0;
  double lighting_error = 0;
  double ghost = 0;
};

/// One policy in one light.
struct RunSummary {
  std::string light;
  std::string run;
  std::string policy;
  std::string budget;
  FrameMeans moving;
  FrameMeans still;       // frames after the light has stopped
  FrameMeans just_after;  // the kJustAfter-th of them, as in Overbeck 2006, figure 7.1
};
inline constexpr int kJustAfter = 5;

/// The frames in motion; all when none moves.
std::vector<const FrameRow*> frames_that_count(const std::vector<FrameRow>& rows);
FrameMeans mean_of(const std::vector<const FrameRow*>& frames);

/// In the order of the rows, which are in runs.
std::vector<RunSummary> summarize_runs(const std::vector<FrameRow>& rows);

}  // namespace rimlight
