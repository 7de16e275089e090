#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/report/brdf_edit.h"

namespace rimlight {

/// One run over a whole session.
struct CurveRunSummary {
  std::string run, policy, budget;
  // Frames in which a curve changes: means; the median of their times.
  double moving_error_l2 = 0, moving_terms = 0, median_ms = 0;
  double worst_error_l2 = 0;
  /// Of the last frame before each rest, and the fifth of the rest (kJustAfterEdit), means.
  double last_moving_error_l2 = 0, just_after_error_l2 = 0;
  /// How many frames the curve that a stroke ends with needed, its first one counted, until it was
  /// held exactly: the most of all strokes with a rest. Nothing where one's rest was too short.
  std::optional<int> frames_to_exact;
};
inline constexpr int kJustAfterEdit = 5;

/// In the order of the rows, which are run by run.
std::vector<CurveRunSummary> summarize_curve_runs(std::span<const CurveFrameRow> rows);

}  // namespace rimlight
