#include "core/base/parallel.h"

#include <gtest/gtest.h>
#include <pmmintrin.h>

#include <atomic>
#include <stdexcept>
#include <vector>

#include "core/base/aligned_vector.h"

namespace rimlight {
namespace {

/// Bounds the threads for one test.
class ThreadCount {
 public:
  explicit ThreadCount(int threads) { set_thread_count(threads); }
  ~ThreadCount() { set_thread_count(0); }
  ThreadCount(const ThreadCount&) = delete;
  ThreadCount& operator=(const ThreadCount&) = delete;
};

TEST(ParallelFor, EveryIndexComesExactlyOnce) {
  for (const int threads : {1, 2, 4}) {
    const ThreadCount bound(threads);
    EXPECT_EQ(thread_count(), threads);
    for (const std::size_t count : {0u, 1u, 2u, 7u, 10'000u}) {
      std::vector<std::atomic<int>> calls(count);
      parallel_for(count, [&](std::size_t i) { ++calls.at(i); });
      for (const auto& one : calls) ASSERT_EQ(one.load(), 1);
    }
  }
}

TEST(ParallelFor, WhatTheBodiesWroteIsSeenAfterwards) {
  std::vector<std::size_t> squares(5000);
  parallel_for(squares.size(), [&](std::size_t i) { squares[i] = i * i; });
  for (std::size_t i = 0; i < squares.size(); ++i) ASSERT_EQ(squares[i], i * i);
}

TEST(ParallelFor, AnExceptionOfABodyComesOutAndNoBodyRunsAfterwards) {
  std::atomic<int> running = 0;
  for (int trial = 0; trial < 50; ++trial) {
    EXPECT_THROW(parallel_for(200,
                              [&](std::size_t i) {
                                ++running;
                                if (i % 50 == 17) {
                                  --running;
                                  throw std::runtime_error("seventeen");
                                }
                                --running;
                              }),
                 std::runtime_error);
    ASSERT_EQ(running.load(), 0);
  }
  int calls = 0;  // and the next loop works
  parallel_for(1, [&](std::size_t) { ++calls; });
  EXPECT_EQ(calls, 1);
}

TEST(ParallelFor, LoopsNest) {
  constexpr std::size_t kSide = 40;
  std::vector<std::atomic<int>> calls(kSide * kSide);
  parallel_for(kSide, [&](std::size_t i) {
    parallel_for(kSide, [&](std::size_t j) { ++calls[i * kSide + j]; });
  });
  for (const auto& one : calls) ASSERT_EQ(one.load(), 1);
  EXPECT_THROW(parallel_for(4,
                            [&](std::size_t) {
                              parallel_for(4, [](std::size_t) { throw std::logic_error("inner"); });
                            }),
               std::logic_error);
}

TEST(ParallelFor, DenormalsAreFlushedInEveryBody) {
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_OFF);  // whatever tests before this one have set
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_OFF);
  std::atomic<int> kept = 0;
  parallel_for(1000, [&](std::size_t) {
    if (_MM_GET_FLUSH_ZERO_MODE() != _MM_FLUSH_ZERO_ON ||
        _MM_GET_DENORMALS_ZERO_MODE() != _MM_DENORMALS_ZERO_ON) {
      ++kept;
    }
  });
  EXPECT_EQ(kept.load(), 0);
}

TEST(ThreadCount, ZeroMeansAllCoresAgain) {
  set_thread_count(0);
  const int all = thread_count();
  EXPECT_GE(all, 1);
  {
    const ThreadCount bound(1);
    EXPECT_EQ(thread_count(), 1);
  }
  EXPECT_EQ(thread_count(), all);
}

TEST(AlignedVector, StartsOnACacheLineAtAnySize) {
  for (std::size_t size = 1; size < 200; ++size) {
    const AlignedVector<char> vector(size);
    ASSERT_EQ(reinterpret_cast<std::uintptr_t>(vector.data()) % 64, 0u);
  }
}

}  // namespace
}  // namespace rimlight
