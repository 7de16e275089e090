#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <limits>

namespace rimlight::server {

/// What one client's messages wait for, from when each is sent to its acknowledgement. A message
/// takes a base (the way there and back, and what the client does with any message), and a time for
/// its bytes. The queue delay of a message is what it took beyond the base: its own bytes on a
/// narrow link, what others have in the same queue, a client that cannot follow.
///
/// With at most one message in flight, the least delay of frames that are all about as large holds
/// their own bytes, and would hide a narrow link. So least delays are kept apart by size (classes
/// of powers of two, over the last 5 to 10 s), and where there are sizes a factor of 2 apart (exact
/// frames and their parts against frames in motion), the line through them gives the time of a byte
/// and the base. The time of a byte is kept when the sizes are no longer seen. One thread at a
/// time.
class DelayMeter {
 public:
  using Clock = std::chrono::steady_clock;

  /// A message of `bytes` was acknowledged `delay_ms` after it was sent; returns its queue delay in
  /// ms. Of the first it is 0: nothing is known yet.
  double record(std::size_t bytes, double delay_ms, Clock::time_point now);

  /// What a message without bytes would take, in ms.
  double base_ms() const { return base_ms_; }
  /// What each byte adds, in ms; 0 until two sizes were seen.
  double ms_per_byte() const { return ms_per_byte_; }

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();
  static constexpr std::chrono::seconds kEpoch{5};
  /// Sizes in [2^(i-1), 2^i).
  static constexpr std::size_t kClasses = 40;

  struct Least {
    double delay_ms = kNone;
    double bytes = 0;
    void take(const Least& other) {
      if (other.delay_ms < delay_ms) *this = other;
    }
  };
  using Epoch = std::array<Least, kClasses>;

  void estimate();

  Epoch current_{}, before_{};
  Clock::time_point current_since_{};
  double base_ms_ = 0;
  double ms_per_byte_ = 0;
};

}  // namespace rimlight::server
