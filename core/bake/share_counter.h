#pragma once

#include <cstddef>
#include <functional>
#include <mutex>

namespace rimlight {

/// Counts parts of a work as threads finish them, and tells the share that is done: under a lock,
/// so from one thread at a time, and rising. Any thread.
class ShareCounter {
 public:
  ShareCounter(std::size_t count, const std::function<void(double)>& done)
      : count_(count), done_(done) {}

  void add_one() {
    const std::lock_guard lock(mutex_);
    ++finished_;
    if (done_) done_(static_cast<double>(finished_) / static_cast<double>(count_));
  }

 private:
  std::size_t count_;
  const std::function<void(double)>& done_;
  std::mutex mutex_;
  std::size_t finished_ = 0;
};

}  // namespace rimlight
