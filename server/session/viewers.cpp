#include "server/session/viewers.h"

#include <algorithm>
#include <set>
#include <utility>

namespace rimlight::server {

void Viewers::join(const std::shared_ptr<Client>& client, Part part, const Display& display) {
  viewers_.emplace_back(client, ++joined_, width_, height_);
  viewers_.back().only_watches = part == Part::watches;
  viewers_.back().set_display(display);
}

void Viewers::leave(const Client& client) {
  std::erase_if(viewers_, [&](const Viewer& viewer) { return viewer.client.get() == &client; });
}

const Viewers::Viewer* Viewers::find(const Client& client) const {
  const auto found = std::find_if(viewers_.begin(), viewers_.end(), [&](const Viewer& viewer) {
    return viewer.client.get() == &client;
  });
  return found == viewers_.end() ? nullptr : &*found;
}

Viewers::Viewer* Viewers::find_viewer(const Client& client) {
  return const_cast<Viewer*>(std::as_const(*this).find(client));
}

void Viewers::set_display(const Client& client, const Display& display, Clock::time_point now) {
  Viewer* const viewer = find_viewer(client);
  if (viewer == nullptr) return;
  viewer->set_display(display);
  if (newest_ && newest_->revision == expected_) offer_newest(*viewer, now);
}

bool Viewers::any_visible() const {
  return std::any_of(viewers_.begin(), viewers_.end(),
                     [](const Viewer& viewer) { return !viewer.is_hidden(); });
}

bool Viewers::any_ready() const {
  return std::any_of(viewers_.begin(), viewers_.end(), [&](const Viewer& viewer) {
    return viewer.is_ready() && may_take(viewer, false);
  });
}

bool Viewers::may_take(const Viewer& viewer, bool is_exact) const {
  return is_exact || !editors_first_ || !viewer.only_watches;
}

bool Viewers::all_shown() const {
  return !newest_ || std::all_of(viewers_.begin(), viewers_.end(), [&](const Viewer& viewer) {
    return viewer.is_hidden() || (viewer.is_ready() && !viewer.lacks(newest_->frame));
  });
}

bool Viewers::is_lacking(const Viewer& viewer) const {
  return newest_ && viewer.is_ready() && may_take(viewer, newest_->is_exact) &&
         viewer.lacks(newest_->frame) && !find_newest(viewer);
}

bool Viewers::any_lacking() const {
  return newest_ && newest_->revision == expected_ &&
         std::any_of(viewers_.begin(), viewers_.end(),
                     [&](const Viewer& viewer) { return is_lacking(viewer); });
}

bool Viewers::has_exact() const { return newest_ && newest_->is_exact; }

bool Viewers::has_stream(const Viewer& viewer) const {
  return viewer.rung() < kVp8Rungs && streams_[viewer.rung()].follows(viewer.kept());
}

EncodedPtr Viewers::find_lossless() const {
  const auto found = std::find_if(encoded_.begin(), encoded_.end(),
                                  [](const EncodedPtr& frame) { return !frame->order.rung; });
  return found == encoded_.end() ? nullptr : *found;
}

bool Viewers::wants_preview(const Viewer& viewer) const {
  const EncodedPtr lossless = find_lossless();
  return lossless && viewer.would_split(lossless->payload->size()) &&
         viewer.has_not_seen(newest_->revision);
}

EncodedPtr Viewers::find_newest(const Viewer& viewer) const {
  const bool is_preview = wants_preview(viewer);
  const auto found = std::find_if(encoded_.begin(), encoded_.end(), [&](const EncodedPtr& frame) {
    return frame->is_preview == is_preview && viewer.accepts(*frame, has_stream(viewer));
  });
  return found == encoded_.end() ? nullptr : *found;
}

void Viewers::offer_newest(const Client& client, Clock::time_point now) {
  if (Viewer* const viewer = find_viewer(client)) offer_newest(*viewer, now);
}

void Viewers::offer_newest(Viewer& viewer, Clock::time_point now) {
  if (!newest_ || !viewer.is_ready() || !viewer.lacks(newest_->frame)) return;
  if (!may_take(viewer, newest_->is_exact)) return;
  const EncodedPtr frame = find_newest(viewer);
  if (!frame) return;
  // Parts of what is out of date would only be in the way of the frame that is to come.
  const bool in_parts = !frame->order.rung && viewer.would_split(frame->payload->size());
  if (in_parts && newest_->revision < expected_) return;
  viewer.send(frame, now);
}

std::vector<EncodeOrder> Viewers::show(const DrawnPicture& picture, Clock::time_point now) {
  newest_ = picture;
  encoded_.clear();
  return plan(SharedStream::Kind::new_picture, now);
}

std::vector<EncodeOrder> Viewers::show_again(Clock::time_point now) const {
  return newest_ ? plan(SharedStream::Kind::repeat, now) : std::vector<EncodeOrder>{};
}

std::vector<EncodeOrder> Viewers::plan(SharedStream::Kind kind, Clock::time_point now) const {
  if (newest_->is_exact) {
    return find_lossless() ? plan_previews() : std::vector<EncodeOrder>{EncodeOrder{}};
  }
  std::vector<EncodeOrder> orders;
  std::array<bool, kRungs.size()> wants{};
  for (std::size_t rung = 0; rung < kVp8Rungs; ++rung) {
    const std::optional<StreamFrame> frame = plan_stream(rung, kind, now);
    if (frame) orders.push_back({rung, frame});
    for (const Viewer& viewer : viewers_) {
      if (viewer.rung() != rung || !is_lacking(viewer)) continue;
      if (!frame || !frame->can_follow(viewer.kept())) {
        wants[jpeg_instead_of(rung)] |= !has_stream(viewer);
      }
    }
  }
  for (const Viewer& viewer : viewers_) {
    wants[viewer.rung()] |= viewer.rung() >= kVp8Rungs && is_lacking(viewer);
  }
  for (std::size_t rung = kVp8Rungs; rung < kRungs.size(); ++rung) {
    if (wants[rung]) orders.push_back({rung, std::nullopt});
  }
  return orders;
}

std::vector<EncodeOrder> Viewers::plan_previews() const {
  std::set<std::size_t> rungs;
  for (const Viewer& viewer : viewers_) {
    if (is_lacking(viewer)) rungs.insert(viewer.preview_rung());
  }
  std::vector<EncodeOrder> orders;
  for (const std::size_t rung : rungs) orders.push_back({rung, std::nullopt});
  return orders;
}

std::optional<StreamFrame> Viewers::plan_stream(std::size_t rung, SharedStream::Kind kind,
                                                Clock::time_point now) const {
  std::vector<SharedStream::Member> members;
  for (const Viewer& viewer : viewers_) {
    if (!viewer.is_member(rung, now)) continue;
    members.push_back(viewer.as_member());
    members.back().is_ready = is_lacking(viewer);
  }
  return streams_[rung].plan(members, kind, now);
}

void Viewers::offer(const EncodedPtr& frame, Clock::time_point now) {
  const EncodeOrder& order = frame->order;
  if (order.stream) streams_[*order.rung].made(*order.stream, now);
  if (!newest_ || frame->header.frame != newest_->frame) return;
  encoded_.push_back(frame);
  const bool must_reach_all =
      order.stream && (order.stream->links.is_key() || order.stream->links.to_golden);
  for (Viewer& viewer : viewers_) {
    if (!viewer.lacks(newest_->frame) || !may_take(viewer, newest_->is_exact)) continue;
    if (viewer.is_ready()) {
      offer_newest(viewer, now);
    } else if (must_reach_all && viewer.is_member(*order.rung, now)) {
      const SharedStream::Member member = viewer.as_member();
      if (member.can_owe && order.stream->can_follow(member.kept)) viewer.owe(frame);
    }
  }
}

AckResult Viewers::acknowledge(const Client& client, std::int64_t frame, Clock::time_point now) {
  Viewer* const viewer = find_viewer(client);
  if (viewer == nullptr) return AckResult::not_in_flight;
  const AckResult result = viewer->acknowledge(frame, expected_, now);
  if (result == AckResult::taken) offer_newest(*viewer, now);
  return result;
}

void Viewers::forget_newest() {
  newest_.reset();
  encoded_.clear();
  for (SharedStream& stream : streams_) stream.lost();
}

}  // namespace rimlight::server
