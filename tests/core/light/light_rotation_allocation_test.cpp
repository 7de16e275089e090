// A warm rotator makes no allocation.
#include <gtest/gtest.h>

#include "core/light/light_rotation.h"
#include "tests/core/light/light_samples.h"
#include "tests/support/allocation_count.h"

namespace rimlight {
namespace {

TEST(LightRotation, AllocatesNothingOnceWarm) {
  if (!test::kCountsAllocations) GTEST_SKIP() << "ThreadSanitizer has an operator new of its own";
  Random random(61);
  CubeLight light = random_light(32, random);
  light.values[100] = 1e5f;  // so that there is an excess
  LightRotator rotator(std::move(light));
  CubeLight target;
  const std::size_t cold = test::allocation_count();
  rotator.rotate(random_rotation(random), target);
  EXPECT_GT(test::allocation_count(), cold) << "the count is alive: `target` was empty";
  const std::size_t warm = test::allocation_count();
  for (int i = 0; i < 100; ++i) rotator.rotate(random_rotation(random), target);
  EXPECT_EQ(test::allocation_count(), warm);
}

}  // namespace
}  // namespace rimlight
