#include "server/session/viewer.h"

#include <algorithm>
#include <utility>

#include "core/base/check.h"
#include "core/image/vp8_codec.h"

namespace rimlight::server {
namespace {

/// Who has not answered for so long is not waited for by a stream.
constexpr std::chrono::seconds kLive{1};

double milliseconds(Viewer::Clock::duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

}  // namespace

Viewer::Viewer(std::shared_ptr<Client> client_, std::int64_t number_, int width, int height)
    : client(std::move(client_)),
      number(number_),
      width_(width),
      height_(height),
      climber_(rungs_for({}, width, height)) {}

void Viewer::set_display(const Display& display) {
  const bool had_vp8 = display_.vp8;
  const std::size_t rung = climber_.rung();
  display_ = display;
  display_.vp8 = display.vp8 && has_vp8();
  climber_.set_range(rungs_for(display_, width_, height_));
  // A decoder that is new has nothing; one that is hidden is not waited for.
  if (!had_vp8 || climber_.rung() != rung) leave_stream();
  if (display_.hidden) owed_.reset();
}

void Viewer::leave_stream() {
  kept_ = {};
  owed_.reset();
}

bool Viewer::is_member(std::size_t rung, Clock::time_point now) const {
  return rung < kVp8Rungs && climber_.rung() == rung && !display_.hidden &&
         (!in_flight_ || now - in_flight_->sent < kLive);
}

SharedStream::Member Viewer::as_member() const {
  KeptPictures kept = kept_;
  if (owed_) owed_->order.stream->keep(kept);
  return {kept, is_ready(), !owed_};
}

bool Viewer::accepts(const EncodedFrame& frame, bool has_stream) const {
  if (!frame.order.rung) return true;
  if (frame.is_preview) return *frame.order.rung == preview_rung();
  if (frame.order.stream) {
    return *frame.order.rung == rung() && frame.order.stream->can_follow(kept_);
  }
  if (rung() < kVp8Rungs) return !has_stream && *frame.order.rung == jpeg_instead_of(rung());
  return *frame.order.rung == rung();
}

std::size_t Viewer::preview_rung() const {
  const std::size_t first = rungs_for({.most_pixels = display_.most_pixels}, width_, height_).first;
  return server::preview_rung(parts_.bytes(), first, width_, height_);
}

void Viewer::send(const EncodedPtr& frame, Clock::time_point now) {
  RIMLIGHT_CHECK(!in_flight_);
  shown_ = frame->header.frame - (frame->is_preview ? 1 : 0);
  seen_ = frame->header.revision;
  if (frame->order.stream) frame->order.stream->keep(kept_);
  send_part(frame, 0, now);
}

void Viewer::send_part(const EncodedPtr& frame, std::size_t offset, Clock::time_point now) {
  const std::size_t size = frame->payload->size();
  const bool may_split = display_.parts && !frame->order.rung;
  const std::size_t most = may_split ? parts_.bytes() : size;
  const std::size_t bytes = std::min(most, size - offset);
  FrameHeader header = frame->header;
  header.wait_ms = std::max(0.0, milliseconds(now - frame->made));
  if (bytes < size) header.part = {offset, size};
  const FramePtr message = write_frame_message(header, frame->payload, bytes);
  in_flight_ = {frame, message->size(), offset + bytes, now};
  client->send_frame(message);
}

void Viewer::measure(const InFlight& acknowledged, Clock::time_point now) {
  const double delay_ms = milliseconds(now - acknowledged.sent);
  const double queue_ms = meter_.record(acknowledged.bytes, delay_ms, now);
  parts_.record(acknowledged.bytes, delay_ms, queue_ms, meter_.ms_per_byte());
  const EncodeOrder& order = acknowledged.frame->order;
  const std::size_t rung = climber_.rung();
  // A key frame is larger than those that the rung is judged by.
  const bool is_key = order.stream && order.stream->links.is_key();
  if (order.rung && !is_key) climber_.record(*order.rung, queue_ms, now);
  climber_.expect(meter_.ms_per_byte(), double{1} * width_ * height_ / (512 * 512));
  if (climber_.rung() != rung) leave_stream();
}

AckResult Viewer::acknowledge(std::int64_t frame, const Revision& newest, Clock::time_point now) {
  if (!in_flight_ || in_flight_->frame->header.frame != frame) return AckResult::not_in_flight;
  const InFlight done = *std::exchange(in_flight_, std::nullopt);
  measure(done, now);
  const bool has_rest = done.end < done.frame->payload->size();
  if (has_rest && display_.hidden) shown_ = frame - 1;  // the whole again when it shows again
  if (display_.hidden) return AckResult::taken;
  if (has_rest && done.frame->header.revision >= newest) {
    send_part(done.frame, done.end, now);
    return AckResult::taken;
  }
  const EncodedPtr owed = std::exchange(owed_, nullptr);
  if (owed && lacks(owed->header.frame)) send(owed, now);
  return AckResult::taken;
}

}  // namespace rimlight::server
