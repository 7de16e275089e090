#pragma once

#include <cstddef>
#include <cstdint>

namespace rimlight::test {

// ThreadSanitizer brings an operator new that cannot be replaced.
#ifdef RIMLIGHT_THREAD_SANITIZER
inline constexpr bool kCountsAllocations = false;
#else
inline constexpr bool kCountsAllocations = true;
#endif

/// How often the calling thread has called operator new so far, in a binary that links
/// allocation_count.cpp; always 0 without kCountsAllocations.
std::size_t allocation_count();
/// Bytes that operator new gave to any thread and that were not given back, with what the allocator
/// rounds up.
std::size_t live_bytes();

/// As long as it lives, the n-th allocation of all threads fails, counted from 0, or all from then
/// on: calls of operator new, and of whatever else asks fails_now(). One at a time.
class FailingAllocation {
 public:
  enum class Lasting { once, from_then_on };
  FailingAllocation(std::int64_t n, Lasting lasting);
  ~FailingAllocation();
  FailingAllocation(const FailingAllocation&) = delete;
  FailingAllocation& operator=(const FailingAllocation&) = delete;

  /// Since it was made.
  static std::int64_t allocations();
  /// Counts one; whether it is to fail.
  static bool fails_now() noexcept;
};

}  // namespace rimlight::test
