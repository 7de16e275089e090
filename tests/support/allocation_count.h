#pragma once

#include <cstddef>

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

}  // namespace rimlight::test
