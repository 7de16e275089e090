#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <mutex>

namespace rimlight::server {

/// Who may be asked to leave while it waits.
class Guest {
 public:
  virtual ~Guest() = default;
  /// Any thread; at once: closed on its own strand, if it still waits then.
  virtual void make_way() = 0;
};

/// Sockets that have been promised nothing yet: in TLS' handshake, before a header has come whole,
/// or after a refusal. They cost a stranger nothing, so that they have a bound of their own: when
/// one more comes, the one that has waited longest is closed. An honest client needs milliseconds
/// here; who drips bytes makes way for others long before its deadline. Any thread.
class WaitingRoom {
 public:
  explicit WaitingRoom(std::size_t most) : most_(most) {}

  /// A place that its socket has until this ends.
  class Seat {
   public:
    Seat(WaitingRoom& room, const std::shared_ptr<Guest>& socket) : room_(room) {
      std::shared_ptr<Guest> oldest;
      {
        const std::lock_guard lock(room_.mutex_);
        if (room_.waiting_.size() >= room_.most_) {
          oldest = room_.waiting_.front().lock();
          // To the end of the row: it goes, and must not be told again for each who comes.
          room_.waiting_.splice(room_.waiting_.end(), room_.waiting_, room_.waiting_.begin());
        }
        place_ = room_.waiting_.insert(room_.waiting_.end(), socket);
      }
      if (oldest) oldest->make_way();
    }
    Seat(const Seat&) = delete;
    Seat& operator=(const Seat&) = delete;
    ~Seat() {
      const std::lock_guard lock(room_.mutex_);
      room_.waiting_.erase(place_);
    }

   private:
    WaitingRoom& room_;
    std::list<std::weak_ptr<Guest>>::iterator place_;
  };

 private:
  const std::size_t most_;
  std::mutex mutex_;
  std::list<std::weak_ptr<Guest>> waiting_;  // the oldest first
};

}  // namespace rimlight::server
