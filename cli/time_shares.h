#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <string>
#include <utility>

namespace rimlight {

/// What ends work that has no time left.
struct OutOfTime {};

/// Shares a bounded time out between experiments by their weights: each may take its part of what
/// is left when it begins, so that what one does not need goes to those after it. One thread.
class TimeShares {
 public:
  using Clock = std::chrono::steady_clock;
  using Progress = std::function<void(const std::string& stage, double share)>;

  explicit TimeShares(std::chrono::duration<double> total) : total_(total) {}

  /// Before begin(): an experiment of that weight is to come.
  void expect(double weight) { weights_ += weight; }
  void begin(Clock::time_point now = Clock::now()) {
    end_ = now + std::chrono::duration_cast<Clock::duration>(total_);
  }
  /// The next one begins. What it tells the result goes on to `inner`, or throws OutOfTime when its
  /// share is used up.
  Progress next(double weight, Progress inner, Clock::time_point now = Clock::now()) {
    const double part = weights_ > 0 ? std::min(1.0, weight / weights_) : 1;
    weights_ -= weight;
    share_ = std::max(Clock::duration::zero(),
                      std::chrono::duration_cast<Clock::duration>((end_ - now) * part));
    return
        [deadline = now + share_, inner = std::move(inner)](const std::string& stage, double done) {
          if (Clock::now() >= deadline) throw OutOfTime{};
          inner(stage, done);
        };
  }
  /// Of the one that began last.
  double share_seconds() const { return std::chrono::duration<double>(share_).count(); }

 private:
  const std::chrono::duration<double> total_;
  Clock::time_point end_{};
  Clock::duration share_{};
  double weights_ = 0;
};

}  // namespace rimlight
