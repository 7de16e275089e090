#pragma once

#include <chrono>
#include <utility>

namespace rimlight {

/// Time since it was made, or since the last lap.
class Stopwatch {
 public:
  double elapsed_ms() const { return milliseconds(Clock::now() - start_); }
  double elapsed_seconds() const { return elapsed_ms() * 1e-3; }

  /// The time so far; from now on it counts anew.
  double lap_ms() {
    const Clock::time_point now = Clock::now();
    return milliseconds(now - std::exchange(start_, now));
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double milliseconds(Clock::duration time) {
    return std::chrono::duration<double, std::milli>(time).count();
  }

  Clock::time_point start_ = Clock::now();
};

}  // namespace rimlight
