// Counts every allocation of this test program, to see that a warm rotator makes none.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "core/light/light_rotation.h"
#include "tests/core/light/light_samples.h"

namespace {
std::atomic<long> allocations{0};

void* allocate(std::size_t size, std::size_t alignment) {
  ++allocations;
  const std::size_t rounded = (size + alignment - 1) / alignment * alignment;
  if (void* const memory = std::aligned_alloc(alignment, rounded)) return memory;
  throw std::bad_alloc();
}
}  // namespace

void* operator new(std::size_t size) { return allocate(size, 16); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace rimlight {
namespace {

TEST(LightRotation, AllocatesNothingOnceWarm) {
  Random random(61);
  CubeLight light = random_light(32, random);
  light.values[100] = 1e5f;  // so that there is an excess
  LightRotator rotator(std::move(light));
  CubeLight target;
  const long cold = allocations;
  rotator.rotate(random_rotation(random), target);
  EXPECT_GT(allocations, cold) << "the count is alive: `target` was empty";
  const long warm = allocations;
  for (int i = 0; i < 100; ++i) rotator.rotate(random_rotation(random), target);
  EXPECT_EQ(allocations, warm);
}

}  // namespace
}  // namespace rimlight
