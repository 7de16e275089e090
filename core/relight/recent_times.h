#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace rimlight {

/// What something takes, from its last five times: their median, since one that lost its core for a
/// moment tells nothing of the next.
class RecentTimes {
 public:
  void add(double ms) {
    last_[next_++ % last_.size()] = ms;
    count_ = std::min(count_ + 1, last_.size());
  }

  /// 0 before the first.
  double typical_ms() const {
    auto known = last_;
    const auto middle = known.begin() + static_cast<std::ptrdiff_t>(count_ / 2);
    std::nth_element(known.begin(), middle, known.begin() + static_cast<std::ptrdiff_t>(count_));
    return *middle;
  }

 private:
  std::array<double, 5> last_{};
  std::size_t next_ = 0, count_ = 0;
};

}  // namespace rimlight
