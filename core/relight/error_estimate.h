#pragma once

#include "core/light/cube_light.h"
#include "core/relight/held_light.h"
#include "core/transport/sketch.h"

namespace rimlight {

/// How far an image is from its reference, as norms of linear radiance: √ of the sum of squares
/// over receivers and channels.
struct ErrorEstimate {
  double error = 0;     // ‖M·target − M̂·held‖: compression included
  double residual = 0;  // ‖M̂·(target − held)‖: the part that time will mend
};

/// Estimates the error of an image from its sketches, without its reference and without the image
/// (core/transport/sketch.h). Relative standard deviation about 3 % where the error is spread over
/// the image. One thread at a time; computes on all cores, allocates nothing after the first call.
class ErrorEstimator {
 public:
  /// The sketch outlives it.
  explicit ErrorEstimator(const Sketch& sketch) : sketch_(sketch) {}

  /// Lights are coefficients.
  ErrorEstimate estimate(const CubeLight& target, const HeldLight& held);

 private:
  const Sketch& sketch_;
  AlignedVector<float> residual_;  // [3][parts]
};

}  // namespace rimlight
