#include "server/session/frame_maker.h"

namespace rimlight::server {

/// An uploaded environment goes to the source when it is shown first.
void FrameMaker::prepare(const DesignState& state) {
  if (!source_) source_ = scene_.make_source();
  if (added_.contains(state.environment)) return;
  if (const EnvironmentPtr uploaded = environments_.find_uploaded(state.environment)) {
    source_->add_environment(uploaded);
    added_.insert(state.environment);
  }
}

FrameMaker::Made FrameMaker::make(const FrameTask& task, const std::function<bool()>& abandon) {
  prepare(task.state);
  FrameReport report;
  if (!task.exact) {
    source_->set_budget_share(queue_.overload().budget_share(queue_.now()));
    report = source_->render_moving(task.state, image_);
  } else if (!source_->render_exact(task.state, image_, report, abandon)) {
    return {};
  }
  return {encode(task, report), report.unfinished};
}

FramePtr FrameMaker::encode(const FrameTask& task, const FrameReport& report) {
  const Clock::time_point start = queue_.now();
  if (task.exact) {
    encode_png(image_, payload_);
  } else {
    jpeg_.encode(image_, jpeg_quality_, payload_);
  }
  FrameHeader header;
  header.frame = frames_++;
  header.revision = task.revision;
  header.codec = task.exact ? Codec::png : Codec::jpeg;
  header.width = image_.width;
  header.height = image_.height;
  header.exact = task.exact;
  header.terms = static_cast<std::int64_t>(report.terms);
  header.residual = report.residual;
  header.estimate = report.estimate;
  header.unshown = report.unshown;
  header.queue_ms = task.queue_ms;
  header.rotate_ms = report.rotate_ms;
  header.update_ms = report.update_ms;
  header.display_ms = report.display_ms;
  header.encode_ms = std::chrono::duration<double, std::milli>(queue_.now() - start).count();
  return write_frame_message(header, payload_);
}

}  // namespace rimlight::server
