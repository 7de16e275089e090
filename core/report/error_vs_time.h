#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/light/environment.h"
#include "core/light/light_sequence.h"
#include "core/report/frame_row.h"
#include "core/report/light_study.h"
#include "core/report/timed_policy.h"
#include "core/transport/bake_folder.h"

namespace rimlight {

struct ErrorVsTimeSettings {
  /// Each is the sequence's "given" light in turn; empty: the bake's own. A sequence without one is
  /// played once.
  std::vector<std::shared_ptr<const Environment>> lights;
  LightSequence sequence;
  std::vector<TimedPolicy> policies = default_timed_policies();
  int most_frames = 0;  // of the sequence, from its first; 0: all
};

/// What one run's frames did over a short interval, as figure 5.3 shows it.
struct CoverageSample {
  std::string run;
  int first_frame = 0;
  int frames = 0;
  Coverage coverage;
};

/// What belongs to a light and not to one frame.
struct LightReport {
  std::string light;
  std::vector<std::vector<double>> spatio_temporal_norms;  // see spatio_temporal_norms()
  std::vector<CoverageSample> coverage;
};

struct ErrorVsTimeReport {
  std::string scene;
  std::string sequence;
  bool has_reference_rows = false;  // else errors are against the stored transport's exact image
  std::size_t receivers = 0;        // measured on
  int cube_size = 0;                // N
  std::vector<TimedPolicy> policies;
  std::vector<FrameRow> rows;  // light by light, policy by policy, frame by frame
  std::vector<LightReport> lights;
};

/// Told what goes on, and how much of it is done, in [0, 1].
using ReportProgress = std::function<void(const std::string& stage, double fraction)>;

/// Plays a light sequence through every policy, for every light, and measures every frame. Throws
/// Error when a policy is to take as long as one that does not come before it, or for lights that
/// the sequence cannot use. Memory: the sequence's coefficients, and its images at the measured
/// receivers.
ErrorVsTimeReport measure_error_vs_time(const Bake& bake, const ErrorVsTimeSettings& settings,
                                        const ReportProgress& progress);

}  // namespace rimlight
