#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/image/codec.h"
#include "core/image/picture_scaler.h"
#include "core/image/vp8_codec.h"
#include "server/delivery/encoded_frame.h"
#include "server/delivery/ladder.h"
#include "server/metrics/server_metrics.h"
#include "server/schedule/render_queue.h"
#include "server/session/scene_catalog.h"
#include "server/session/session_environments.h"

namespace rimlight::server {

/// A frame to make, from the state that was current when its work began.
struct FrameTask {
  DesignState state;
  Revision revision;
  bool exact = false;
  double queue_ms = 0;                         // from when it was wanted
  std::optional<Clock::time_point> edit = {};  // since when its latency counts: EditAges
};

/// Draws a session's pictures, and encodes each once for all who want it so. The compute thread's
/// own: what it draws and encodes with is kept between frames, so that nothing but what is sent is
/// allocated after warm-up.
class FrameMaker {
 public:
  /// `jpeg_quality`: of the best rung of JPEG. `scene`, `environments`, and `queue`, which tells
  /// the time, must outlive it.
  FrameMaker(const ServedScene& scene, const SessionEnvironments& environments, int jpeg_quality,
             const RenderQueue& queue, std::shared_ptr<ServerMetrics> metrics = unread_metrics())
      : scene_(scene),
        environments_(environments),
        jpeg_quality_(jpeg_quality),
        queue_(queue),
        metrics_(std::move(metrics)) {}

  struct Drawn {
    std::optional<DrawnPicture> picture;  // none: abandoned
    Unfinished unfinished = Unfinished::nothing;
  };
  /// Only exact pictures are ever abandoned. Throws what the scene's source does.
  Drawn draw(const FrameTask& task, const std::function<bool()>& abandon);
  /// The picture that was drawn last. Throws Error when it cannot be encoded.
  EncodedPtr encode(const EncodeOrder& order);
  /// Gives back what it draws with, until it draws again.
  void rest();
  /// FrameSource::improve(), after a picture was drawn.
  Unfinished improve(const std::function<bool()>& abandon) { return source_->improve(abandon); }

 private:
  const Rgb8Image& picture_by(int divisor);
  Payload compress(const EncodeOrder& order, FrameHeader& header);

  void prepare(const DesignState& state);

  const ServedScene& scene_;
  const SessionEnvironments& environments_;
  const int jpeg_quality_;
  const RenderQueue& queue_;
  const std::shared_ptr<ServerMetrics> metrics_;
  std::unique_ptr<FrameSource> source_;
  FrameHeader header_;                           // of the picture
  std::map<std::string, EnvironmentPtr> added_;  // uploaded environments that it has
  Rgb8Image image_;
  PictureScaler scaler_;
  struct Smaller {
    std::int64_t frame = -1;  // of which picture
    Rgb8Image image;
  };
  std::map<int, Smaller> smaller_;  // by divisor
  JpegEncoder jpeg_;
  std::array<std::unique_ptr<Vp8Encoder>, kVp8Rungs> streams_;
  std::int64_t frames_ = 0;
};

}  // namespace rimlight::server
