#include "server/session/frame_maker.h"

#include <utility>

namespace rimlight::server {

/// An uploaded environment goes to the source when it is shown first. A source cannot forget one:
/// where another has taken its name, or too many have come and gone, a new source is made.
void FrameMaker::prepare(const DesignState& state) {
  const EnvironmentPtr uploaded = environments_.find_uploaded(state.environment);
  const auto added = added_.find(state.environment);
  const bool is_added = added != added_.end() && added->second == uploaded;
  if (uploaded && !is_added && (added != added_.end() || added_.size() >= kMostUploads)) rest();
  if (!source_) source_ = scene_.make_source();
  if (!uploaded || is_added) return;
  source_->add_environment(uploaded);
  added_[state.environment] = uploaded;
}

void FrameMaker::rest() {
  source_.reset();
  added_.clear();
  smaller_.clear();
  image_ = {};
}

FrameMaker::Drawn FrameMaker::draw(const FrameTask& task, const std::function<bool()>& abandon) {
  prepare(task.state);
  FrameReport report;
  if (!task.exact) {
    source_->set_budget_share(queue_.overload().budget_share(queue_.now()));
    report = source_->render_moving(task.state, image_);
  } else if (!source_->render_exact(task.state, image_, report, abandon)) {
    return {};
  }
  header_ = {};
  header_.frame = frames_++;
  header_.revision = task.revision;
  header_.exact = task.exact;
  header_.terms = static_cast<std::int64_t>(report.terms);
  header_.residual = report.residual;
  header_.estimate = report.estimate;
  header_.unshown = report.unshown;
  header_.queue_ms = task.queue_ms;
  header_.rotate_ms = report.rotate_ms;
  header_.update_ms = report.update_ms;
  header_.display_ms = report.display_ms;
  metrics_->frame_drawn(header_);
  return {DrawnPicture{header_.frame, task.revision, task.exact}, report.unfinished};
}

EncodedPtr FrameMaker::encode(const EncodeOrder& order) {
  const Clock::time_point start = queue_.now();
  auto frame = std::make_shared<EncodedFrame>();
  frame->order = order;
  frame->header = header_;
  frame->is_preview = header_.exact && order.rung;
  frame->header.exact = header_.exact && !order.rung;
  frame->payload = compress(order, frame->header);
  frame->made = queue_.now();
  frame->header.encode_ms = std::chrono::duration<double, std::milli>(frame->made - start).count();
  metrics_->frame_made(frame->header);
  return frame;
}

const Rgb8Image& FrameMaker::picture_by(int divisor) {
  if (divisor == 1) return image_;
  Smaller& smaller = smaller_[divisor];
  if (std::exchange(smaller.frame, header_.frame) != header_.frame) {
    scaler_.shrink(image_, divisor, smaller.image);
  }
  return smaller.image;
}

Payload FrameMaker::compress(const EncodeOrder& order, FrameHeader& header) {
  auto bytes = std::make_shared<std::vector<std::uint8_t>>();
  const Rgb8Image& picture = picture_by(order.rung ? kRungs[*order.rung].divisor : 1);
  header.width = picture.width;
  header.height = picture.height;
  if (!order.rung) {
    header.codec = Codec::png;
    encode_png(picture, *bytes);
    return bytes;
  }
  const Rung& rung = kRungs[*order.rung];
  header.codec = rung.codec;
  header.rung = static_cast<int>(*order.rung);
  header.quality = *order.rung == kVp8Rungs ? jpeg_quality_ : rung.quality;
  if (order.stream) {
    auto& stream = streams_[*order.rung];
    if (!stream) {
      stream = std::make_unique<Vp8Encoder>(picture.width, picture.height, rung.quality);
    }
    header.key = order.stream->links.is_key();
    stream->encode(picture, order.stream->links, *bytes);
  } else {
    jpeg_.encode(picture, *header.quality, *bytes);
  }
  return bytes;
}

}  // namespace rimlight::server
