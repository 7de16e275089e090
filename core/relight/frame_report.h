#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rimlight {

/// Work that can be done between frames, until none is left: for the frame after the next edit, or
/// even for the exact frame of this state.
enum class Unfinished : std::uint8_t { nothing, next_edits, exact_frame };

/// How one frame came about.
struct FrameReport {
  bool exact = false;
  std::size_t terms = 0;        // columns added, or coefficients of the light
  std::size_t bands_reset = 0;  // bands that started from zero; all of them when exact
  /// ‖target − held‖₁ / ‖target‖₁ of the lighting, area-weighted; of several layers of transport
  /// the mean by their energies. 0 when exact.
  double residual = 0;
  /// Estimated relative L2 error of the image, linear radiance, compression included (see
  /// ErrorEstimator; of vertices VertexEstimator and MovingSquares): of this frame, or of one a few
  /// frames ago where time is short. Nothing for a black image, or where none is made.
  std::optional<double> estimate;
  std::optional<double> estimate_of_time;  // the part of it that time will mend
  double rotate_ms = 0;                    // light rotation and its transform
  double update_ms = 0;                    // policy and columns; of a view its rays too
  double display_ms = 0;                   // composite and tone map
  double estimate_ms = 0;
  Unfinished unfinished = Unfinished::nothing;  // what improve() would do
  /// What the state asks for and this frame does not show, in words for people.
  std::vector<std::string> unshown;
};

}  // namespace rimlight
