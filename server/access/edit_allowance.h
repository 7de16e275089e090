#pragma once

#include <chrono>
#include <cstddef>

namespace rimlight::server {

/// What a client may still send: a bucket that fills at a steady rate, holds a few seconds' worth,
/// and is emptied by the cost of each message. A message that the bucket cannot pay is refused and
/// still costs a quarter, so that at up to four times the rate a client is served at the rate;
/// beyond that the debt grows, and at a full bucket of it the client is to be closed. One strand.
class EditAllowance {
 public:
  using Time = std::chrono::steady_clock::time_point;
  enum class Verdict { granted, refused, hopeless };

  static constexpr double kBucketSeconds = 4;
  static constexpr double kRefusedShare = 0.25;

  /// `rate`: messages of no size a second, positive; starts full.
  EditAllowance(double rate, Time now) : rate_(rate), level_(rate * kBucketSeconds), last_(now) {}

  /// A message costs 1, and 1 more for each KiB.
  static double cost(std::size_t bytes) { return 1 + static_cast<double>(bytes) / 1024; }

  Verdict spend(double cost, Time now);
  /// Gives back what a message cost that should have been free.
  void refund(double cost);

 private:
  double capacity() const { return rate_ * kBucketSeconds; }

  double rate_;
  double level_;
  Time last_;
};

}  // namespace rimlight::server
