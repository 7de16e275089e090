// What a frame does again and again makes no allocation.
#include <gtest/gtest.h>

#include "core/basis/sh_product.h"
#include "core/basis/sh_product_matrix.h"
#include "tests/core/basis/sh_product_cases.h"
#include "tests/support/allocation_count.h"

namespace rimlight {
namespace {

constexpr std::size_t kLanes = ShProduct::kLaneMultiple;

TEST(ShProduct, AllocatesNothingButItsWorkspaceOnce) {
  if (!test::kCountsAllocations) GTEST_SKIP() << "ThreadSanitizer has an operator new of its own";
  const ShProduct product({4, 4, 4});
  std::vector<float> f(sh::coefficient_count(4) * kLanes, 1.0f), h(f.size());
  ShProduct::Workspace workspace;
  const std::size_t cold = test::allocation_count();
  product.multiply(f, f, h, kLanes, workspace);
  const std::size_t warm = test::allocation_count();
  EXPECT_GT(warm, cold) << "the count is alive";
  product.multiply(f, f, h, kLanes, workspace);
  EXPECT_EQ(test::allocation_count(), warm);
}

TEST(ShProductMatrix, AllocatesNothingOnceMade) {
  if (!test::kCountsAllocations) GTEST_SKIP() << "ThreadSanitizer has an operator new of its own";
  ShProductMatrix matrix(4);
  const std::vector<float> light(ShProductMatrix::kChannels * sh::coefficient_count(8), 1);
  const std::vector<float> transport(matrix.size() * kLanes, 1.0f);
  std::vector<float> product(ShProductMatrix::kChannels * transport.size());
  const std::size_t before = test::allocation_count();
  matrix.set_light(light);
  matrix.add_light(light, {1, 1});
  add_product_degrees(matrix, {0, 4}, transport, product, kLanes);
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_NE(product[0], 0);
}

}  // namespace
}  // namespace rimlight
