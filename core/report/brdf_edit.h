#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/curves/curve_session.h"
#include "core/light/environment.h"
#include "core/report/curve_run.h"
#include "core/report/stale_curves.h"
#include "core/transport/bake_folder.h"

namespace rimlight {

struct BrdfEditSettings {
  CurveSession session;
  std::shared_ptr<const Environment> light;  // null: the bake's first
  std::vector<CurveRun> runs = default_curve_runs();
  int most_frames = 0;  // of the session, from its first; 0: all
};

/// One frame of one run. Errors are of the direct light of all editable materials, over all their
/// rows, linear RGB, relative to the norm of its exact image in that frame.
struct CurveFrameRow {
  std::string run, policy, budget;  // CurveRun::name(); its parts
  std::size_t stroke = 0;           // of the session: says material and axis
  int frame = 0;
  bool moving = false;
  int frames_since_edit = 0;  // since the curve last changed
  double plan_ms = 0, apply_ms = 0;
  std::size_t terms = 0, bytes = 0;  // columns of T̂ that were added; what they take
  double error_l2 = 0;               // against the exact image of T̂, summed in double
  double estimate = 0;               // of error_l2: what curves still lack, by their Gram matrix
  bool exact = false;                // all curves are the ones asked for

  double ms() const { return plan_ms + apply_ms; }
};

/// What a stroke of the session needed, and where it ended.
struct StrokeReport {
  int first_frame = 0;
  /// T′ of its material for its axis, made just before, on all threads; 0 where it was there.
  double transport_ms = 0, norms_ms = 0;
  /// Of the stroke's last exact image against sums over all texels of the light, from a sample of
  /// rows, relative: what storing T′ in 16 bits costs.
  double stored_l2 = 0;
};

struct BrdfEditReport {
  std::string scene, light;
  CurveSession session;
  int cube_size = 0;  // N
  std::size_t row_count = 0, panel_count = 0;
  std::vector<CurveRun> runs;
  std::vector<CurveFrameRow> rows;  // run by run, frame by frame
  std::vector<StrokeReport> strokes;
  std::vector<StaleCurveRow> stale;
};

/// Told what goes on, and how much of it is done, in [0, 1].
using BrdfEditProgress = std::function<void(const std::string& stage, double share)>;

/// Plays a session through every run, each from the exact image of the bake as it is, frame by
/// frame in turn, so that whatever slows the machine slows them all; then measures what a stale T′
/// costs. A stroke over another axis than its material is shown on begins when T′ of that axis is
/// made, which counts for no run. Throws Error as EditedCurves. Memory: T′, and two images a run.
BrdfEditReport measure_brdf_edit(const std::shared_ptr<const Bake>& bake,
                                 const BrdfEditSettings& settings,
                                 const BrdfEditProgress& progress);

}  // namespace rimlight
