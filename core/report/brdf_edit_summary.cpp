#include "core/report/brdf_edit_summary.h"

#include <algorithm>

namespace rimlight {
namespace {

/// A mean of what is added.
class Mean {
 public:
  void add(double value) {
    sum_ += value;
    ++count_;
  }
  double value() const { return count_ > 0 ? sum_ / count_ : 0; }

 private:
  double sum_ = 0;
  int count_ = 0;
};

/// The upper one of an even number; 0 of none.
double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// The frames of one run and stroke, of which some follow the last edit.
std::optional<int> frames_to_exact(std::span<const CurveFrameRow> stroke) {
  const auto last =
      std::ranges::find_if(stroke,
                           [](const CurveFrameRow& row) { return row.frames_since_edit > 0; }) -
      1;  // the frame of the last edit
  const auto exact = std::find_if(last, stroke.end(), [](const auto& row) { return row.exact; });
  if (exact == stroke.end()) return std::nullopt;
  return static_cast<int>(exact - last) + 1;
}

/// The most of all strokes with a rest.
std::optional<int> most_frames_to_exact(std::span<const CurveFrameRow> rows) {
  std::optional<int> most;
  for (auto begin = rows.begin(); begin != rows.end();) {
    const auto end = std::find_if(begin, rows.end(),
                                  [&](const auto& row) { return row.stroke != begin->stroke; });
    if ((end - 1)->frames_since_edit > 0) {
      const auto frames = frames_to_exact({begin, end});
      if (!frames) return std::nullopt;
      most = std::max(most.value_or(0), *frames);
    }
    begin = end;
  }
  return most;
}

CurveRunSummary summarize(std::span<const CurveFrameRow> rows) {
  CurveRunSummary summary;
  summary.run = rows[0].run;
  summary.policy = rows[0].policy;
  summary.budget = rows[0].budget;
  Mean error, terms, last_moving, just_after;
  std::vector<double> ms;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const CurveFrameRow& row = rows[i];
    if (row.frames_since_edit == kJustAfterEdit) just_after.add(row.error_l2);
    if (row.frames_since_edit == 1) last_moving.add(rows[i - 1].error_l2);
    if (!row.moving) continue;
    error.add(row.error_l2);
    terms.add(static_cast<double>(row.terms));
    ms.push_back(row.ms());
    summary.worst_error_l2 = std::max(summary.worst_error_l2, row.error_l2);
  }
  summary.moving_error_l2 = error.value();
  summary.moving_terms = terms.value();
  summary.median_ms = median(std::move(ms));
  summary.last_moving_error_l2 = last_moving.value();
  summary.just_after_error_l2 = just_after.value();
  summary.frames_to_exact = most_frames_to_exact(rows);
  return summary;
}

}  // namespace

std::vector<CurveRunSummary> summarize_curve_runs(std::span<const CurveFrameRow> rows) {
  std::vector<CurveRunSummary> summaries;
  for (auto begin = rows.begin(); begin != rows.end();) {
    const auto end =
        std::find_if(begin, rows.end(), [&](const auto& row) { return row.run != begin->run; });
    summaries.push_back(summarize({begin, end}));
    begin = end;
  }
  return summaries;
}

}  // namespace rimlight
