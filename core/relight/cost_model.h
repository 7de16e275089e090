#pragma once

#include <cstddef>

namespace rimlight {

/// What a batch of columns takes, learnt from the batches before:
///
///     milliseconds = fixed + work · per_unit
///
/// with work as FrameUpdater counts it. per_unit follows the measured batches within a few frames,
/// a single slow one by little: most of those have lost their core for a moment. A batch too small
/// to tell anything makes the next one larger, so that a guess that was too slow is not believed
/// for ever. Starts from such a guess.
class CostModel {
 public:
  /// Work that a batch may do to take `milliseconds`, at most 10¹⁵; 0 when there is no time for
  /// any.
  std::size_t work_within(double milliseconds) const;
  /// A batch was measured.
  void learn(std::size_t work, double milliseconds);

  double milliseconds_per_million() const { return 1e6 * per_unit_; }

 private:
  static constexpr double kFixedMs = 0.05;       // waking the threads
  static constexpr double kFirstGuess = 0.2e-6;  // milliseconds: a block in 1.6 ns
  double per_unit_ = kFirstGuess;
};

}  // namespace rimlight
