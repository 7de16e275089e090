#include "tests/support/allocation_count.h"

#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <limits>
#include <new>

namespace {

thread_local std::size_t count = 0;
std::atomic<std::size_t> live{0};

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
std::atomic<bool> is_failing{false};
std::atomic<std::int64_t> calls{0}, first_fault{kNever}, last_fault{kNever};

#ifndef RIMLIGHT_THREAD_SANITIZER
void* try_counted(std::size_t size, std::size_t alignment) noexcept {
  ++count;
  if (rimlight::test::FailingAllocation::fails_now()) return nullptr;
  const std::size_t rounded = (size + alignment - 1) / alignment * alignment;
  void* const memory = std::aligned_alloc(alignment, rounded == 0 ? alignment : rounded);
  live.fetch_add(::malloc_usable_size(memory), std::memory_order_relaxed);
  return memory;
}
void give_back(void* memory) noexcept {
  live.fetch_sub(::malloc_usable_size(memory), std::memory_order_relaxed);
  std::free(memory);
}
void* counted(std::size_t size, std::size_t alignment) {
  void* const memory = try_counted(size, alignment);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
#endif

}  // namespace

namespace rimlight::test {

std::size_t allocation_count() { return count; }
std::size_t live_bytes() { return live.load(std::memory_order_relaxed); }

FailingAllocation::FailingAllocation(std::int64_t n, Lasting lasting) {
  calls = 0;
  first_fault = n;
  last_fault = lasting == Lasting::once ? n : kNever;
  is_failing = true;
}
FailingAllocation::~FailingAllocation() { is_failing = false; }

std::int64_t FailingAllocation::allocations() { return calls; }

bool FailingAllocation::fails_now() noexcept {
  if (!is_failing.load(std::memory_order_relaxed)) return false;
  const std::int64_t n = calls++;
  return n >= first_fault && n <= last_fault;
}

}  // namespace rimlight::test

#ifndef RIMLIGHT_THREAD_SANITIZER
// The other forms of new and delete end in these.
void* operator new(std::size_t size) { return counted(size, alignof(std::max_align_t)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return counted(size, static_cast<std::size_t>(alignment));
}
// These end in the ones above as well, but not where AddressSanitizer brings its own.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return try_counted(size, alignof(std::max_align_t));
}
void* operator new(std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return try_counted(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { give_back(memory); }
void operator delete(void* memory, std::size_t) noexcept { give_back(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { give_back(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { give_back(memory); }
#endif
