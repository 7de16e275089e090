#pragma once

#include <memory>
#include <vector>

#include "core/light/cube_light.h"
#include "core/light/light_sequence.h"

namespace rimlight {

struct LightFrame {
  int index = 0;
  double seconds = 0;
  bool moving = false;  // LightSequence::is_moving
  CubeLight light;      // texels
};

/// Makes the light of a sequence's frames on a cube map of one size. A frame has the same bits
/// whichever frames were asked for before; frames that do not move have the bits of the frame
/// before. Asking in order is cheapest: a frame then costs a turn of each environment that turns,
/// one disc for each area light, and the new spots of each painting. Allocates nothing after the
/// first frame. One thread at a time.
class LightSequencePlayer {
 public:
  /// `size` is 2 … cube::kLargestSize; `environments` has every name that the sequence uses, as
  /// load_environments() makes it. Throws Error naming an environment of which a texel is brighter
  /// than 1e30, which sums of tracks could push over the range of floats.
  LightSequencePlayer(LightSequence sequence, int size, const LightEnvironments& environments);
  LightSequencePlayer(LightSequencePlayer&& other) noexcept;
  LightSequencePlayer& operator=(LightSequencePlayer&& other) noexcept;
  ~LightSequencePlayer();

  const LightSequence& sequence() const { return sequence_; }

  /// `frame` is 0 … frame_count() − 1. Valid until the next call.
  const LightFrame& at(int frame);

 private:
  class TrackLight;

  LightSequence sequence_;
  std::vector<std::unique_ptr<TrackLight>> tracks_;
  LightFrame frame_;
};

}  // namespace rimlight
