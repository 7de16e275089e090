#pragma once

// Includes Asio: for the network layer's own .cpp files only.

#include <atomic>
#include <boost/asio/thread_pool.hpp>
#include <cstddef>
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

  /// A place at the desk, given back with this; none when all are taken.
  class Place {
   public:
    explicit Place(UploadDesk& desk) : desk_(desk), taken_(++desk.open_ <= kMost) {}
    Place(const Place&) = delete;
    Place& operator=(const Place&) = delete;
    ~Place() { --desk_.open_; }
    bool is_taken() const { return taken_; }

   private:
    UploadDesk& desk_;
    const bool taken_;
  };

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
