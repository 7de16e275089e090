#include "core/math/random.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/statistics.h"

namespace rimlight {
namespace {

using test::Histogram;
using test::Mean;

constexpr double kSigmas = 6;  // a right generator fails one of these tests once in 1e7 seeds
constexpr int kDraws = 200'000;

TEST(Random, MixesAsPublished) {
  // The first outputs of SplitMix64 with seed 0 (Vigna's splitmix64.c).
  constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15ULL;
  static_assert(mix_bits(kStep) == 0xe220a8397b1dcdafULL);
  static_assert(mix_bits(2 * kStep) == 0x6e789e6aa1b965f4ULL);
}

TEST(Random, TheSameSeedGivesTheSameNumbersAndOthersOthers) {
  Random a(5, 7), same(5, 7);
  std::set<std::uint64_t> firsts;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    for (std::uint64_t stream = 0; stream < 300; ++stream) {
      firsts.insert(Random(seed, stream).bits());
    }
  }
  EXPECT_EQ(firsts.size(), 90'000u);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(a.bits(), same.bits());
}

TEST(Random, UniformNumbersAreUniformAndBelowOne) {
  Random random(1);
  Histogram doubles(128), floats(128), shifted(128);
  for (int i = 0; i < kDraws; ++i) {
    const double u = random.uniform();
    const float f = random.uniform_float();
    const double s = random.uniform(-3, 5);
    ASSERT_TRUE(u >= 0 && u < 1 && f >= 0 && f < 1 && s >= -3 && s < 5);
    doubles.add(u);
    floats.add(f);
    shifted.add((s + 3) / 8);
  }
  EXPECT_LT(std::abs(doubles.score()), kSigmas);
  EXPECT_LT(std::abs(floats.score()), kSigmas);
  EXPECT_LT(std::abs(shifted.score()), kSigmas);
}

TEST(Random, BelowStaysBelowAndIsUniform) {
  Random random(2);
  for (const std::uint64_t count : {1ull, 2ull, 3ull, 1ull << 32, (1ull << 63) + 1, ~0ull}) {
    for (int i = 0; i < 1000; ++i) ASSERT_LT(random.below(count), count);
  }
  for (const std::size_t count : {101u, 128u, 1000u}) {
    std::vector<std::size_t> bins(count);
    for (int i = 0; i < kDraws; ++i) ++bins[random.below(count)];
    EXPECT_LT(std::abs(test::uniformity_score(bins)), kSigmas) << count;
  }
}

// One generator for each pixel: what neighbours draw must not be related.
TEST(Random, NeighbouringStreamsAndSuccessiveNumbersAreUncorrelated) {
  Mean streams, seeds, successive;
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    Random one(3, i), next(3, i + 1), other(4 + i, 0), after(5 + i, 0);
    const double first = one.uniform() - 0.5;
    streams.add(first * (next.uniform() - 0.5));
    successive.add(first * (one.uniform() - 0.5));
    seeds.add((other.uniform() - 0.5) * (after.uniform() - 0.5));
  }
  EXPECT_LT(std::abs(streams.score(0)), kSigmas);
  EXPECT_LT(std::abs(successive.score(0)), kSigmas);
  EXPECT_LT(std::abs(seeds.score(0)), kSigmas);
}

TEST(Random, TheFirstNumbersOfStreamsAreUniform) {
  Histogram histogram(256);
  for (std::uint64_t stream = 0; stream < kDraws; ++stream) {
    histogram.add(Random(9, stream).uniform());
  }
  EXPECT_LT(std::abs(histogram.score()), kSigmas);
}

}  // namespace
}  // namespace rimlight
