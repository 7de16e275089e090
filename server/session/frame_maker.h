#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/image/codec.h"
#include "server/protocol/frame_message.h"
#include "server/schedule/render_queue.h"
#include "server/session/scene_catalog.h"
#include "server/session/session_environments.h"

namespace rimlight::server {

/// A frame to make, from the state that was current when its work began.
struct FrameTask {
  DesignState state;
  Revision revision;
  bool exact = false;
  double queue_ms = 0;  // from when it was wanted
};

/// Draws a session's frames and encodes them, each once for all clients. The compute thread's own:
/// what it draws with is kept between frames, so that nothing is allocated after warm-up.
class FrameMaker {
 public:
  /// `scene`, `environments`, and `queue`, which tells the time, must outlive it.
  FrameMaker(const ServedScene& scene, const SessionEnvironments& environments, int jpeg_quality,
             const RenderQueue& queue)
      : scene_(scene), environments_(environments), jpeg_quality_(jpeg_quality), queue_(queue) {}

  struct Made {
    FramePtr frame;  // null: abandoned
    Unfinished unfinished = Unfinished::nothing;
  };
  /// Only exact frames are ever abandoned. Throws what the scene's source does.
  Made make(const FrameTask& task, const std::function<bool()>& abandon);
  /// FrameSource::improve(), after a frame was made.
  Unfinished improve(const std::function<bool()>& abandon) { return source_->improve(abandon); }

 private:
  FramePtr encode(const FrameTask& task, const FrameReport& report);

  void prepare(const DesignState& state);

  const ServedScene& scene_;
  const SessionEnvironments& environments_;
  const int jpeg_quality_;
  const RenderQueue& queue_;
  std::unique_ptr<FrameSource> source_;
  std::set<std::string, std::less<>> added_;  // uploaded environments that it has
  Rgb8Image image_;
  JpegEncoder jpeg_;
  std::vector<std::uint8_t> payload_;
  std::int64_t frames_ = 0;
};

}  // namespace rimlight::server
