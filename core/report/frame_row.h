#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/report/transport_errors.h"

namespace rimlight {

/// What the parts of a frame took, in milliseconds: all that a server does for it, but for sending.
struct FrameTimes {
  double light = 0;    // the sequence's light, and its Haar transform
  double plan = 0;     // choosing columns
  double apply = 0;    // adding them
  double display = 0;  // composite and tone map
  double encode = 0;   // JPEG

  double total() const { return light + plan + apply + display + encode; }
};

/// One frame of one policy in one light, measured. Errors are relative to the norm of what they are
/// measured against.
struct FrameRow {
  std::string light;
  std::string run;  // TimedPolicy::name()
  std::string policy;
  std::string budget;  // budget_name()
  int frame = 0;
  bool moving = false;
  int frames_since_edit = 0;  // since the light last changed, or the sequence began
  FrameTimes ms;

  double relative_l2 = 0;            // linear radiance, against the reference
  double psnr_db = 0;                // display-referred, against the reference
  double time_l2 = 0;                // against the exact image of the stored transport
  double psnr_time_db = 0;           // the same
  double compression_l2 = 0;         // of that exact image against the reference
  TransportError of_transport;       // of the reference
  double lighting_error = 0;         // ‖held − target‖₁ / ‖target‖₁, area-weighted
  std::optional<double> estimate;    // of relative_l2, over all receivers; none of a black image
  double ghost = 0;                  // GhostEnergy::held
  double ghost_of_target = 0;        // GhostEnergy::target
  std::size_t columns = 0;           // added
  std::size_t bytes = 0;             // of transport, read for them
  std::uint32_t reset_bands = 0;     // a bit a band
  std::vector<int> columns_of_band;  // added
};

}  // namespace rimlight
