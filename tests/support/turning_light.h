#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/basis/cube_haar.h"
#include "core/light/cube_light.h"
#include "core/light/environment.h"

namespace rimlight::test {

/// The sequence that the papers measure policies on (Overbeck 2006, figures 5.1 and 6.2): a light
/// that turns about the vertical, slowly at first, then stands still.
struct TurningLight {
  int turning_frames = 100;
  int still_frames = 60;
  double most_degrees_a_frame = 3;  // reached in the last turning frame

  int frame_count() const { return turning_frames + still_frames; }
};

/// Coefficients of all its frames.
std::vector<CubeLight> turn(const Environment& environment, const CubeHaar& haar,
                            const TurningLight& settings);

/// A policy with a budget in coefficients, and the light that is held before the first frame.
struct PolicyRun {
  enum class Start { exact, nothing };
  std::string policy;
  std::size_t budget = 30;
  Start start = Start::exact;  // what the papers' incremental policies start from
};

/// ‖target − held‖ / ‖target‖ after each frame, area-weighted L1. For those that weigh by
/// transport, every column's norm is its area weight, so that all measure alike.
std::vector<double> lighting_errors(const CubeHaar& haar, const std::vector<CubeLight>& frames,
                                    const PolicyRun& run);

/// The mean of the first `count`.
double mean_of_first(const std::vector<double>& errors, int count);

/// How many still frames it takes until the error is below `level`; one more than there are when it
/// never is.
int still_frames_until_below(const std::vector<double>& errors, const TurningLight& settings,
                             double level);

}  // namespace rimlight::test
