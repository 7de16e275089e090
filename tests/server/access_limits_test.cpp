#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "server/access/address_limit.h"
#include "server/access/edit_allowance.h"

namespace rimlight::server {
namespace {

using std::chrono::nanoseconds;
using std::chrono::seconds;
using Verdict = EditAllowance::Verdict;

/// Sends `rate` messages a second for `time`; how many were granted, or -1 when it was hopeless.
int granted(EditAllowance& allowance, EditAllowance::Time& now, int rate, seconds time) {
  int count = 0;
  for (std::int64_t i = 0; i < rate * time.count(); ++i) {
    now += nanoseconds(1'000'000'000 / rate);
    const Verdict verdict = allowance.spend(1, now);
    if (verdict == Verdict::hopeless) return -1;
    count += verdict == Verdict::granted;
  }
  return count;
}

TEST(EditAllowances, GrantTheRateForEverAndAFewSecondsOfItAtOnce) {
  EditAllowance::Time now{};
  EditAllowance steady(100, now);
  EXPECT_EQ(granted(steady, now, 100, seconds(1000)), 100'000);
  EditAllowance burst(100, now);
  int count = 0;
  while (burst.spend(1, now) == Verdict::granted) ++count;
  EXPECT_EQ(count, 100 * EditAllowance::kBucketSeconds);
}

TEST(EditAllowances, ServeAtAboutTheRateWhoSendsSomewhatMoreAndGiveUpOnAFlood) {
  EditAllowance::Time now{};
  EditAllowance eager(100, now);
  const int served = granted(eager, now, 200, seconds(100));
  // Each refusal costs a quarter: g + (200 - g)/4 = 100 a second, and the bucket at first.
  EXPECT_NEAR(served, 6667 + 400, 200);
  EditAllowance flood(100, now);
  EXPECT_EQ(granted(flood, now, 1000, seconds(100)), -1);
}

TEST(EditAllowances, RecoverInAFewSecondsOfQuiet) {
  EditAllowance::Time now{};
  EditAllowance allowance(10, now);
  while (allowance.spend(1, now) != Verdict::hopeless) {
  }
  now += seconds(9);
  EXPECT_EQ(allowance.spend(40, now), Verdict::granted);
  now -= seconds(5);  // a clock that goes back gives nothing
  EXPECT_EQ(allowance.spend(20, now), Verdict::refused);
}

TEST(EditAllowances, LargeMessagesCostMoreAndAcknowledgementsNothing) {
  EXPECT_EQ(EditAllowance::cost(0), 1);
  EXPECT_EQ(EditAllowance::cost(64 * 1024), 65);
  const EditAllowance::Time now{};
  EditAllowance allowance(1, now);  // a bucket of 4
  EXPECT_EQ(allowance.spend(EditAllowance::cost(1 << 16), now), Verdict::granted);
  EXPECT_EQ(allowance.spend(1, now), Verdict::refused);
  allowance.refund(1000);
  for (int i = 0; i < 1000; ++i) {
    ASSERT_EQ(allowance.spend(1, now), Verdict::granted);
    allowance.refund(1);
  }
}

TEST(AddressLimits, CountWhoIsThereAndForgetWhoIsNot) {
  AddressLimit limit;
  EXPECT_EQ(limit.enter("a"), 1u);
  EXPECT_EQ(limit.enter("a"), 2u);
  EXPECT_EQ(limit.enter("b"), 1u);
  limit.leave("a");
  EXPECT_EQ(limit.enter("a"), 2u);
  for (const char* const address : {"a", "a", "b", "b", "none"}) limit.leave(address);
  EXPECT_EQ(limit.size(), 0u);
  std::vector<std::jthread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&limit] {
      for (int j = 0; j < 1000; ++j) {
        limit.enter("a");
        limit.leave("a");
      }
    });
  }
  threads.clear();
  EXPECT_EQ(limit.size(), 0u);
}

TEST(AddressLimits, OneSubscriberIsOneAddressHoweverItIsWritten) {
  EXPECT_EQ(counted_address("192.0.2.1"), "192.0.2.1");
  EXPECT_EQ(counted_address("::ffff:192.0.2.1"), "192.0.2.1");
  EXPECT_EQ(counted_address("2001:db8:1:2:3:4:5:6"), counted_address("2001:db8:1:2::1"));
  EXPECT_NE(counted_address("2001:db8:1:2::1"), counted_address("2001:db8:1:3::1"));
  EXPECT_NE(counted_address("192.0.2.1"), counted_address("192.0.2.2"));
  EXPECT_EQ(counted_address("nonsense"), "nonsense");
}

}  // namespace
}  // namespace rimlight::server
