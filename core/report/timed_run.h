#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/basis/cube_haar.h"
#include "core/light/light_sequence_player.h"
#include "core/relight/background.h"
#include "core/report/frame_row.h"
#include "core/report/measured_receivers.h"
#include "core/report/timed_policy.h"
#include "core/report/transport_errors.h"
#include "core/transport/bake_folder.h"

namespace rimlight {

/// A frame as it should be. Images are of the measured receivers.
struct ReferenceFrame {
  bool moving = false;
  CubeLight target;              // coefficients
  std::vector<Vec3f> exact;      // of the stored transport
  std::vector<Vec3f> reference;  // of the uncompressed one; empty without its rows
  double exposure = 1;           // that the image is judged at
  double compression_l2 = 0;     // relative error of `exact`
  TransportError of_transport;   // of `reference`

  const std::vector<Vec3f>& truth() const { return reference.empty() ? exact : reference; }
};

/// The frames of a light in time, and what shows them.
struct LitSequence {
  std::string light;
  LightSequencePlayer player;
  /// The same at TransportErrors::finer_size(), where that is not 0.
  std::optional<LightSequencePlayer> finer_player;
  std::vector<ReferenceFrame> frames;
  /// What stands behind the pixels, where a single environment turns; else the frame's own light.
  std::shared_ptr<const BackgroundMap> background;
};

/// Makes the first `count` frames of a sequence. `progress` is told of shares in [0, 1].
void find_references(const Bake& bake, const MeasuredReceivers& receivers,
                     const TransportErrors& errors, int count,
                     const std::function<void(double)>& progress, LitSequence& sequence);

/// What one policy made of a sequence.
struct TimedRun {
  std::vector<FrameRow> rows;
  std::vector<std::vector<std::uint32_t>> chosen;  // columns added, by frame
};

/// Plays a sequence through a policy, from the exact image of its first frame, as a session shows
/// before an edit; measures each frame. Only what FrameTimes names is on the clock.
TimedRun play(const Bake& bake, const MeasuredReceivers& receivers, const TimedPolicy& policy,
              LitSequence& sequence);

}  // namespace rimlight
