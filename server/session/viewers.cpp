#include "server/session/viewers.h"

#include <algorithm>
#include <utility>

namespace rimlight::server {

void Viewers::join(const std::shared_ptr<Client>& client) {
  viewers_.push_back({client, ++joined_});
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

bool Viewers::any_ready() const {
  return std::any_of(viewers_.begin(), viewers_.end(),
                     [](const Viewer& viewer) { return viewer.in_flight == kNone; });
}

void Viewers::offer(const FramePtr& frame) {
  for (Viewer& viewer : viewers_) offer(viewer, frame);
}

void Viewers::offer(const Client& client, const FramePtr& frame) {
  if (Viewer* const viewer = find_viewer(client)) offer(*viewer, frame);
}

void Viewers::offer(Viewer& viewer, const FramePtr& frame) {
  if (viewer.in_flight != kNone) {
    viewer.waiting = frame;  // an older one is dropped, unsent
    return;
  }
  viewer.in_flight = frame->frame;
  viewer.client->send_frame(frame);
}

AckResult Viewers::acknowledge(const Client& client, std::int64_t frame) {
  Viewer* const viewer = find_viewer(client);
  if (viewer == nullptr || viewer->in_flight != frame) return AckResult::not_in_flight;
  viewer->in_flight = kNone;
  if (const FramePtr waiting = std::exchange(viewer->waiting, nullptr)) offer(*viewer, waiting);
  return AckResult::taken;
}

}  // namespace rimlight::server
