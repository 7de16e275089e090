#include "core/relight/cost_model.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rimlight {
namespace {

constexpr std::size_t kBatch = 10'000'000;  // bytes
constexpr double kFixedMs = 0.05;           // what a batch takes beside its bytes

/// A model that has long seen batches of this many milliseconds a megabyte.
CostModel settled(double milliseconds_per_million) {
  CostModel model;
  for (int i = 0; i < 500; ++i) model.learn(kBatch, 10 * milliseconds_per_million + kFixedMs);
  return model;
}

TEST(CostModel, SettlesAtWhatBatchesTake) {
  for (const double rate : {0.01, 0.1, 3.0, 50.0}) {
    const CostModel model = settled(rate);
    EXPECT_NEAR(model.milliseconds_per_million(), rate, 1e-6 * rate);
    // And plans batches that take what was asked for.
    const auto bytes = static_cast<double>(model.work_within(7));
    EXPECT_NEAR(bytes / 1e6 * rate + kFixedMs, 7, 1e-3);
  }
}

TEST(CostModel, FollowsWithinAFewBatchesAndASingleSlowOneByLittle) {
  CostModel up = settled(1), down = settled(1), once = settled(1);
  for (int i = 0; i < 8; ++i) {
    up.learn(kBatch, 10 * 2.0 + kFixedMs);
    down.learn(kBatch, 10 * 0.5 + kFixedMs);
  }
  EXPECT_NEAR(up.milliseconds_per_million(), 2, 0.1);
  EXPECT_NEAR(down.milliseconds_per_million(), 0.5, 0.05);
  once.learn(kBatch, 1e6);
  EXPECT_LE(once.milliseconds_per_million(), 1.61);
  for (int i = 0; i < 15; ++i) once.learn(kBatch, 10 * 1.0 + kFixedMs);
  EXPECT_NEAR(once.milliseconds_per_million(), 1, 0.01);
}

TEST(CostModel, StaysWithinWhatMachinesCanDo) {
  CostModel model;
  for (int i = 0; i < 1000; ++i) model.learn(kBatch, 0);  // less than the fixed part
  EXPECT_NEAR(model.milliseconds_per_million(), 1e-3, 1e-5) << "1 TB/s";
  EXPECT_GT(model.work_within(1), 0u);
  for (int i = 0; i < 1000; ++i) model.learn(kBatch, 1e9);  // the machine slept
  EXPECT_NEAR(model.milliseconds_per_million(), 100, 0.1) << "10 MB/s";
  EXPECT_NEAR(static_cast<double>(model.work_within(1 + kFixedMs)), 1e4, 10);
}

TEST(CostModel, TinyBatchesLeadBackFromAGuessThatWasTooSlow) {
  CostModel model = settled(90);
  const std::size_t tiny = model.work_within(1);
  ASSERT_LT(tiny, 200'000u);
  for (int i = 0; i < 100 && model.work_within(1) < 200'000; ++i) {
    model.learn(model.work_within(1), 1000);  // whatever they took
  }
  EXPECT_GE(model.work_within(1), 200'000u);
}

TEST(CostModel, MoreTimeHoldsMoreBytes) {
  for (const double rate : {1e-3, 0.2, 100.0}) {
    const CostModel model = settled(rate);
    EXPECT_EQ(model.work_within(-3), 0u);
    EXPECT_EQ(model.work_within(0), 0u);
    EXPECT_EQ(model.work_within(kFixedMs), 0u);
    std::size_t previous = 0;
    for (double time = 0.1; time < 1e13; time *= 1.7) {
      const std::size_t bytes = model.work_within(time);
      ASSERT_GE(bytes, previous) << time;
      previous = bytes;
    }
    EXPECT_EQ(previous, std::size_t{1'000'000'000'000'000}) << "no time is too long";
  }
}

}  // namespace
}  // namespace rimlight
