#pragma once

// Includes Asio: for the network layer's own .cpp files only.

#include <atomic>
#include <boost/asio/thread_pool.hpp>
#include <memory>
#include <stop_token>
#include <utility>

#include "server/upload/decoded_environment.h"

namespace rimlight::server {

/// Where uploads are decoded: one after the other, on a thread that may wait. Any thread.
class UploadDesk {
 public:
  /// Uploads under way, of which the bodies are in memory, at most so many.
  static constexpr int kMost = 4;

  explicit UploadDesk(DecoderSettings settings) : settings_(std::move(settings)) {}
  ~UploadDesk() { close(); }
  UploadDesk(const UploadDesk&) = delete;
  UploadDesk& operator=(const UploadDesk&) = delete;

  struct GiveBack {
    void operator()(UploadDesk* desk) const { --desk->open_; }
  };
  /// A place at the desk, given back with this.
  using Place = std::unique_ptr<UploadDesk, GiveBack>;
  /// None when all are taken.
  Place take_place() {
    if (++open_ <= kMost) return Place(this);
    --open_;
    return nullptr;
  }

  boost::asio::thread_pool& pool() { return pool_; }
  /// Of a decoder that stop() ends.
  DecoderSettings settings() const {
    DecoderSettings settings = settings_;
    settings.stop = stop_.get_token();
    return settings;
  }
  /// What is being decoded ends at once, in an error.
  void stop() { stop_.request_stop(); }
  /// The same, and waits until nothing is.
  void close() {
    stop();
    pool_.join();
  }

 private:
  const DecoderSettings settings_;
  std::atomic<int> open_ = 0;
  std::stop_source stop_;
  boost::asio::thread_pool pool_{1};
};

}  // namespace rimlight::server
