#include "server/access/edit_allowance.h"

#include <algorithm>

namespace rimlight::server {

EditAllowance::Verdict EditAllowance::spend(double cost, Time now) {
  const double passed = std::max(0.0, std::chrono::duration<double>(now - last_).count());
  last_ = std::max(last_, now);
  level_ = std::min(capacity(), level_ + rate_ * passed);
  // A message larger than the bucket is paid by a full one: it must not be refused for ever.
  const double due = std::min(cost, capacity());
  if (level_ >= due) {
    level_ -= due;
    return Verdict::granted;
  }
  level_ -= due * kRefusedShare;
  return level_ > -capacity() ? Verdict::refused : Verdict::hopeless;
}

void EditAllowance::refund(double cost) {
  level_ = std::min(capacity(), level_ + std::min(cost, capacity()));
}

}  // namespace rimlight::server
