#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>

namespace rimlight::server {

/// A socket that can be told to end.
class Stoppable {
 public:
  virtual ~Stoppable() = default;
  /// Any thread; at once: the socket closes politely on its own strand.
  virtual void stop() = 0;
};

/// Counts the sockets that are open and tells them all to end. Any thread.
class StopGate {
 public:
  /// False when the gate is closed or `most` are inside.
  bool enter(const std::shared_ptr<Stoppable>& socket, std::size_t most) {
    const std::lock_guard lock(mutex_);
    if (closed_ || inside_.size() >= most) return false;
    inside_.emplace(socket.get(), socket);
    return true;
  }
  void leave(const Stoppable& socket) {
    const std::lock_guard lock(mutex_);
    inside_.erase(&socket);
  }
  /// Nobody enters any more, and all inside are told to stop.
  void close() {
    std::map<const Stoppable*, std::weak_ptr<Stoppable>> inside;
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
      inside = inside_;
    }
    for (const auto& [address, weak] : inside) {
      if (const auto socket = weak.lock()) socket->stop();
    }
  }
  std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return inside_.size();
  }

 private:
  mutable std::mutex mutex_;
  bool closed_ = false;
  std::map<const Stoppable*, std::weak_ptr<Stoppable>> inside_;
};

}  // namespace rimlight::server
