#include "core/transport/column_kernel.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/math/random.h"
#include "tests/support/random_transport.h"
#include "tests/support/reference/columns.h"

namespace rimlight {
namespace {

using test::random_transport;

/// Runs `check` with each SIMD target that this machine supports and the kernel has.
template <typename Check>
void for_each_target(const Check& check) {
  std::vector<std::string> names;
  const std::int64_t compiled = hwy::SupportedTargets() & HWY_TARGETS;
  for (std::int64_t targets = compiled; targets != 0; targets &= targets - 1) {
    hwy::SetSupportedTargetsForTest(targets & -targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    names.emplace_back(column_kernel_target());
    SCOPED_TRACE(names.back());
    check();
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  EXPECT_FALSE(names.empty());
  ::testing::Test::RecordProperty("targets", ::testing::PrintToString(names));
  std::ranges::sort(names);
  EXPECT_EQ(std::ranges::adjacent_find(names), names.end()) << "a target was run twice";
}

std::vector<ColumnDelta> random_deltas(std::size_t columns, double share, std::uint64_t seed) {
  Random random(seed, 99);
  std::vector<ColumnDelta> deltas;
  for (std::uint32_t column = 0; column < columns; ++column) {
    if (random.uniform() >= share) continue;
    const auto value = [&] { return static_cast<float>(random.uniform(-2, 2)); };
    deltas.push_back({column, {value(), value(), value()}});
  }
  return deltas;
}

AlignedVector<float> random_radiance(std::uint64_t seed) {
  Random random(seed, 5);
  AlignedVector<float> radiance(kTileFloats);
  for (float& value : radiance) value = static_cast<float>(random.uniform(-1, 1));
  return radiance;
}

struct Pattern {
  std::size_t columns;
  double density;
  double share;  // of columns in the update
};

TEST(ColumnKernel, EveryTargetIsWithinItsRoundingsOfTheDoubleReference) {
  const std::vector<Pattern> patterns = {{1, 0.5, 1},      {2, 0, 1},        {3, 1, 1},
                                         {37, 0.01, 1},    {100, 0.05, 0.3}, {100, 0.002, 1},
                                         {257, 0.03, 0.05}};
  double worst = 0;
  for (const Pattern& pattern : patterns) {
    const Transport transport = random_transport({.tile_count = 3,
                                                  .column_count = pattern.columns,
                                                  .density = pattern.density,
                                                  .seed = pattern.columns});
    const auto deltas = random_deltas(pattern.columns, pattern.share, 3);
    ASSERT_FALSE(deltas.empty());
    // A term: delta · scale rounds once, its product once (no FMA), its sum once. So three
    // roundings of 2⁻²⁴ for each term, of the magnitudes added up to there.
    const double bound = 3 * 0x1p-24 * static_cast<double>(deltas.size());
    for_each_target([&] {
      for (std::size_t tile = 0; tile < 3; ++tile) {
        AlignedVector<float> radiance = random_radiance(tile);
        const auto expected = reference::add_columns(transport.view(), tile, deltas, radiance);
        add_columns(transport.view(), tile, deltas, radiance.data());
        for (std::size_t i = 0; i < kTileFloats; ++i) {
          const double error = std::abs(radiance[i] - expected.value[i]);
          worst = std::max(worst, error / expected.magnitude[i] / bound);
          ASSERT_TRUE(error <= bound * expected.magnitude[i]) << tile << " " << i;
        }
      }
    });
  }
  RecordProperty("worst_of_bound", std::to_string(worst));
  EXPECT_GT(worst, 0.001) << "nothing was added";
}

TEST(ColumnKernel, EveryFiniteHalfIsAddedExactly) {
  // scale 1, delta 1, radiance 0: what comes out is the half's value itself, on every target.
  std::vector<TileTransport> tiles;
  std::size_t next = 0;
  while (next < 65536) {
    TileTransport& tile = tiles.emplace_back();
    tile.column_scale = {1};
    for (std::uint16_t block = 0; block < kTileBlocks; ++block) {
      tile.block_index.push_back(block);
      for (std::size_t i = 0; i < kBlockFloats; ++i, ++next) {
        const auto half = static_cast<Half>(next < 65536 ? next : 0);
        tile.value.push_back(is_finite(half) ? half : Half{0});
      }
    }
    tile.column_offset = {0, kTileBlocks};
  }
  const Transport transport(tiles);
  const std::vector<ColumnDelta> deltas = {{0, {1, 1, 1}}};
  for_each_target([&] {
    for (std::size_t tile = 0; tile < tiles.size(); ++tile) {
      AlignedVector<float> radiance(kTileFloats);
      add_columns(transport.view(), tile, deltas, radiance.data());
      for (std::size_t i = 0; i < kTileFloats; ++i) {
        ASSERT_EQ(radiance[i], to_float(tiles[tile].value[i])) << tile << " " << i;
      }
    }
  });
}

TEST(ColumnKernel, NoColumnsChangeNothing) {
  const Transport transport = random_transport({});
  const AlignedVector<float> before = random_radiance(1);
  AlignedVector<float> radiance = before;
  add_columns(transport.view(), 0, {}, radiance.data());
  EXPECT_EQ(radiance, before);
}

TEST(ColumnKernel, IsLinearInTheDeltas) {
  const Transport transport = random_transport({.column_count = 50, .density = 0.2});
  auto deltas = random_deltas(50, 1, 8);
  AlignedVector<float> once(kTileFloats), twice(kTileFloats);
  add_columns(transport.view(), 0, deltas, once.data());
  for (ColumnDelta& delta : deltas) delta.delta *= 2;  // exact in binary
  add_columns(transport.view(), 0, deltas, twice.data());
  for (std::size_t i = 0; i < kTileFloats; ++i) ASSERT_EQ(twice[i], 2 * once[i]);
}

TEST(ColumnKernel, BlocksWithoutTransportAreNotTouched) {
  const Transport transport = random_transport({.column_count = 3, .density = 0.1, .seed = 4});
  const auto run = transport.view().run(0, 1);
  AlignedVector<float> radiance(kTileFloats, -0.0f);  // adding +0 would turn it into +0
  add_columns(transport.view(), 0, std::vector<ColumnDelta>{{1, {1, 1, 1}}}, radiance.data());
  std::size_t untouched = 0;
  for (std::size_t block = 0; block < kTileBlocks; ++block) {
    if (std::ranges::binary_search(run.block_index, block)) continue;
    ++untouched;
    for (std::size_t i = 0; i < kBlockFloats; ++i) {
      ASSERT_TRUE(std::signbit(radiance[block * kBlockFloats + i]));
    }
  }
  EXPECT_GT(untouched, 0u);
  EXPECT_LT(untouched, kTileBlocks);
}

}  // namespace
}  // namespace rimlight
