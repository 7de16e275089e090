#pragma once

#include <string>
#include <vector>

#include "core/relight/design_state.h"

namespace rimlight {

/// A curve that is set, or whose points are dragged in so many frames; then so many frames of rest.
struct CurveStroke {
  std::string title;
  std::string material;
  CurveAxis axis = CurveAxis::half_angle;
  /// Of as many points; equal where the curve is set at once.
  CurveEdit from, to;
  int frames = 1;
  int rest = 0;

  /// The curve in frame `step` from 0; from frames − 1 on it is `to`. Dragged points go eased, by
  /// 3x² − 2x³ of the way, on the logarithmic scale in the logarithm of their values.
  CurveEdit at(int step) const;
  int frame_count() const { return frames + rest; }
};

/// A recorded session of curve edits, frame by frame: stroke after stroke. Any thread.
struct CurveSession {
  std::string name;
  std::vector<CurveStroke> strokes;

  /// Where a frame stands.
  struct Place {
    std::size_t stroke = 0;
    int step = 0;
    bool is_moving = false;  // the curve is another than in the frame before
  };

  int frame_count() const;
  /// Of a frame from 0 to frame_count() − 1, else CheckFailure.
  Place place(int frame) const;
  /// Materials that are edited, each once, in the order of their first strokes.
  std::vector<std::string> materials() const;
};

}  // namespace rimlight
