#include "core/relight/column_measures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/base/parallel.h"
#include "tests/support/random_transport.h"
#include "tests/support/reference/columns.h"

namespace rimlight {
namespace {

const test::RandomTransport kSettings{.tile_count = 3, .column_count = 24};

TEST(ColumnMeasures, NormsAreThoseOfTheColumnsImages) {
  const Transport transport = test::random_transport(kSettings);
  const ColumnMeasures measures = measure_columns(transport.view());
  ASSERT_EQ(measures.norm_squared.size(), 3 * kSettings.column_count);
  const std::vector<float> black(kTileFloats);
  int lit = 0;
  for (std::uint32_t column = 0; column < kSettings.column_count; ++column) {
    double expected[3] = {};
    for (std::size_t tile = 0; tile < kSettings.tile_count; ++tile) {
      const std::vector<ColumnDelta> one = {{column, {1, 1, 1}}};
      const auto image = reference::add_columns(transport.view(), tile, one, black);
      for (std::size_t i = 0; i < kTileFloats; ++i) {
        expected[i % kBlockFloats / kBlockReceivers] += image.value[i] * image.value[i];
      }
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const double found = measures.norm_squared[c * kSettings.column_count + column];
      EXPECT_NEAR(found, expected[c], 1e-6 * expected[c]);  // one rounding to float
      lit += found > 0;
    }
  }
  EXPECT_GT(lit, 40);
}

TEST(ColumnMeasures, BytesAreThoseOfTheColumnsBlocks) {
  const Transport transport = test::random_transport(kSettings);
  const ColumnMeasures measures = measure_columns(transport.view());
  std::size_t sum = 0;
  for (std::size_t column = 0; column < kSettings.column_count; ++column) {
    std::size_t blocks = 0;
    for (std::size_t tile = 0; tile < kSettings.tile_count; ++tile) {
      blocks += transport.view().run(tile, column).block_index.size();
    }
    EXPECT_EQ(measures.bytes[column], 50 * blocks);  // an index of 2 bytes, 24 halves
    sum += measures.bytes[column];
  }
  EXPECT_EQ(sum, 50 * transport.view().block_count());
}

TEST(ColumnMeasures, AreTheSameAtAnyThreadCount) {
  const Transport transport = test::random_transport(kSettings);
  const ColumnMeasures expected = measure_columns(transport.view());
  for (const int threads : {1, 3}) {
    set_thread_count(threads);
    EXPECT_EQ(measure_columns(transport.view()).norm_squared, expected.norm_squared);
  }
  set_thread_count(0);
}

}  // namespace
}  // namespace rimlight
