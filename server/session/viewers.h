#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/session/client.h"

namespace rimlight::server {

/// Why a client's frame_ack was not taken.
enum class AckResult { taken, not_in_flight };

/// The clients of a session, and each one's place in the flow of frames: at most one frame in
/// flight, and the newest one waiting, so that a slow client gets fewer frames, never older ones,
/// and always the last. One thread at a time: the session's mutex.
class Viewers {
 public:
  struct Viewer {
    std::shared_ptr<Client> client;
    std::int64_t number = 0;         // of those that have joined, from 1
    std::int64_t in_flight = kNone;  // number of the frame that it has not acknowledged
    FramePtr waiting = nullptr;      // the newest frame that it could not take yet
  };

  bool empty() const { return viewers_.empty(); }
  auto begin() const { return viewers_.begin(); }
  auto end() const { return viewers_.end(); }

  void join(const std::shared_ptr<Client>& client);
  void leave(const Client& client);
  /// Nothing when it has left.
  const Viewer* find(const Client& client) const;
  /// Whether one could be sent a frame at once.
  bool any_ready() const;

  void offer(const FramePtr& frame);
  /// To one alone.
  void offer(const Client& client, const FramePtr& frame);
  /// Sends what waits.
  [[nodiscard]] AckResult acknowledge(const Client& client, std::int64_t frame);

 private:
  static constexpr std::int64_t kNone = -1;

  Viewer* find_viewer(const Client& client);
  static void offer(Viewer& viewer, const FramePtr& frame);

  std::vector<Viewer> viewers_;
  std::int64_t joined_ = 0;  // so far
};

}  // namespace rimlight::server
