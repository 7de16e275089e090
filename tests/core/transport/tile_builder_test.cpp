#include "core/transport/tile_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <thread>
#include <vector>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

constexpr std::size_t kColumns = 41;
constexpr std::size_t kRow = 3 * PixelLayout::kGroupReceivers;
using Rows = std::vector<float>;

/// Dense rows of all groups; most blocks small, so that every threshold cuts somewhere.
std::vector<Rows> random_groups(std::uint64_t seed) {
  std::vector<Rows> groups;
  for (std::size_t group = 0; group < TileBuilder::kGroups; ++group) {
    Random random(seed, group);
    Rows& rows = groups.emplace_back(kColumns * kRow);
    for (std::size_t at = 0; at < rows.size(); at += kBlockReceivers) {
      if (random.uniform() < 0.8) continue;
      const double size = std::pow(10.0, random.uniform(-7, 1));
      for (std::size_t i = 0; i < kBlockReceivers; ++i) {
        rows[at + i] = static_cast<float>(size * random.uniform(-1, 1));
      }
    }
  }
  return groups;
}

std::vector<float> random_weights() {
  Random random(77);
  std::vector<float> weights(kColumns);
  for (float& weight : weights) weight = static_cast<float>(random.uniform(0, 2));
  weights[3] = 0;
  return weights;
}

TileTransport build(const std::vector<Rows>& groups, const std::vector<float>& weights,
                    float threshold) {
  TileBuilder builder(weights, threshold);
  for (std::size_t group = 0; group < groups.size(); ++group) {
    builder.add_group(group, groups[group]);
  }
  return builder.assemble();
}

/// m of a block's entry, from the dense rows.
float dense(const std::vector<Rows>& groups, std::size_t column, std::size_t block,
            std::size_t entry) {
  return groups[block / 8][column * kRow + entry / 8 * 64 + block % 8 * 8 + entry % 8];
}

float largest(const std::vector<Rows>& groups, std::size_t column, std::size_t block) {
  float result = 0;
  for (std::size_t i = 0; i < kBlockFloats; ++i) {
    result = std::max(result, std::abs(dense(groups, column, block, i)));
  }
  return result;
}

TEST(TileBuilder, KeepsExactlyTheBlocksWhoseWeightedLargestIsAboveTheThreshold) {
  const auto groups = random_groups(1);
  const auto weights = random_weights();
  for (const float threshold : {0.0f, 1e-5f, 1e-2f, 0.3f, 1e9f}) {
    const TileTransport tile = build(groups, weights, threshold);
    ASSERT_EQ(tile.column_offset.size(), kColumns + 1);
    std::size_t kept = 0;
    for (std::size_t column = 0; column < kColumns; ++column) {
      std::vector<std::uint16_t> expected;
      for (std::uint16_t block = 0; block < kTileBlocks; ++block) {
        if (largest(groups, column, block) * weights[column] > threshold) expected.push_back(block);
      }
      const std::vector<std::uint16_t> found(
          tile.block_index.begin() + tile.column_offset[column],
          tile.block_index.begin() + tile.column_offset[column + 1]);
      if (threshold > 0) {
        ASSERT_EQ(found, expected) << threshold << " column " << column;
      } else {  // blocks below the halves of their run are left out too
        ASSERT_TRUE(std::ranges::includes(expected, found));
      }
      kept += found.size();
    }
    ASSERT_EQ(kept, tile.block_count());
    EXPECT_EQ(kept == 0, threshold == 1e9f);
  }
}

TEST(TileBuilder, ScalesAreTheLargestOfTheRunAndValuesAreWithinTheirRounding) {
  const auto groups = random_groups(2);
  const TileTransport tile = build(groups, std::vector<float>(kColumns, 1.0f), 1e-6f);
  double worst = 0;
  for (std::size_t column = 0; column < kColumns; ++column) {
    float run_largest = 0;
    for (auto b = tile.column_offset[column]; b < tile.column_offset[column + 1]; ++b) {
      const std::size_t block = tile.block_index[b];
      run_largest = std::max(run_largest, largest(groups, column, block));
      for (std::size_t i = 0; i < kBlockFloats; ++i) {
        const double m = dense(groups, column, block, i);
        const double scale = tile.column_scale[column];
        const double stored = to_float(tile.value[b * kBlockFloats + i]) * scale;
        ASSERT_LE(std::abs(to_float(tile.value[b * kBlockFloats + i])), 1);
        // Half of the last place, of a normal or a subnormal half; the division's own rounding of
        // 2⁻²⁴ comes on top.
        const double bound = std::max(std::abs(m) * (0x1p-11 + 0x1p-23), scale * 0x1p-25);
        worst = std::max(worst, std::abs(stored - m) / bound);
        ASSERT_TRUE(std::abs(stored - m) <= bound) << column << " " << block << " " << i;
      }
    }
    ASSERT_EQ(tile.column_scale[column], run_largest);
  }
  EXPECT_GT(worst, 0.5);
}

TEST(TileBuilder, TheOrderAndTheThreadsOfGroupsChangeNothing) {
  const auto groups = random_groups(3);
  const auto weights = random_weights();
  const TileTransport expected = build(groups, weights, 1e-4f);
  std::vector<std::size_t> order(TileBuilder::kGroups);
  std::iota(order.begin(), order.end(), 0);
  Random random(5);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  TileBuilder builder(weights, 1e-4f);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 3; ++t) {
    threads.emplace_back([&, t] {
      for (std::size_t i = t; i < order.size(); i += 3) {
        builder.add_group(order[i], groups[order[i]]);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(builder.assemble(), expected);
}

TEST(TileBuilder, FlushedDenormalsChangeNothing) {
  auto groups = random_groups(4);
  for (Rows& rows : groups) {
    for (std::size_t i = 0; i < rows.size(); i += 3) rows[i] *= 1e-37f;
  }
  const std::vector<float> weights(kColumns, 1.0f);
  TileTransport plain, flushed;
  std::thread([&] { plain = build(groups, weights, 0); }).join();
  std::thread([&] {
    flush_denormals();
    flushed = build(groups, weights, 0);
  }).join();
  EXPECT_EQ(plain, flushed);
}

TEST(TileBuilder, RefusesWhatIsNotFinite) {
  auto groups = random_groups(5);
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity()}) {
    groups[7][100] = bad;
    TileBuilder builder(std::vector<float>(kColumns, 1.0f), 0);
    EXPECT_THROW(builder.add_group(7, groups[7]), CheckFailure);
  }
}

std::vector<std::uint16_t> blocks_of(const TileTransport& tile, std::size_t column) {
  return {tile.block_index.begin() + tile.column_offset[column],
          tile.block_index.begin() + tile.column_offset[column + 1]};
}

TEST(Prune, KeepsWhatTheBuilderWouldHaveKeptButForRoundingAtTheThreshold) {
  const auto groups = random_groups(6);
  const auto weights = random_weights();
  const TileTransport tile = build(groups, weights, 1e-6f);
  std::size_t same = 0, different = 0;
  for (const float threshold : {1e-6f, 1e-3f, 0.1f, 1e9f}) {
    const TileTransport pruned = prune(tile, weights, threshold);
    const TileTransport direct = build(groups, weights, threshold);
    for (std::size_t column = 0; column < kColumns; ++column) {
      const auto a = blocks_of(pruned, column), b = blocks_of(direct, column);
      std::vector<std::uint16_t> in_one;
      std::ranges::set_symmetric_difference(a, b, std::back_inserter(in_one));
      for (const std::uint16_t block : in_one) {
        const double m = largest(groups, column, block);
        const double rounding = std::max(m * 0x1p-10, tile.column_scale[column] * 0x1p-24);
        EXPECT_LE(std::abs(m * weights[column] - threshold), rounding * weights[column]);
      }
      same += a.size();
      different += in_one.size();
      ASSERT_EQ(pruned.column_scale[column], a.empty() ? 0 : tile.column_scale[column]);
    }
  }
  EXPECT_GT(same, 1000u);
  EXPECT_LT(different, same / 100);
}

TEST(Prune, ByTheThresholdOfTheBuilderWithoutBorderCasesChangesNothing) {
  const auto groups = random_groups(6);
  const auto weights = random_weights();
  const TileTransport tile = build(groups, weights, 1e-3f);
  EXPECT_EQ(prune(tile, weights, 0.9e-3f), tile);
  EXPECT_EQ(prune(tile, weights, 1e9f).block_count(), 0u);
}

TEST(Transport, HoldsTheTilesOneAfterAnother) {
  const auto weights = random_weights();
  const std::vector<TileTransport> tiles = {build(random_groups(7), weights, 1e-3f),
                                            build(random_groups(8), weights, 1e9f),
                                            build(random_groups(9), weights, 1e-2f)};
  Transport made(tiles);
  const Transport transport = std::move(made);  // the view follows its arrays
  for (std::size_t tile = 0; tile < tiles.size(); ++tile) {
    ASSERT_EQ(transport.view().tile_block_count(tile), tiles[tile].block_count());
    for (std::size_t column = 0; column < kColumns; ++column) {
      const ColumnRun run = transport.view().run(tile, column);
      const auto first = tiles[tile].column_offset[column];
      ASSERT_EQ(run.block_index.size(), tiles[tile].column_offset[column + 1] - first);
      ASSERT_EQ(run.scale, tiles[tile].column_scale[column]);
      ASSERT_TRUE(std::ranges::equal(
          run.block_index,
          std::span(tiles[tile].block_index).subspan(first).first(run.block_index.size())));
      ASSERT_TRUE(std::equal(run.values, run.values + run.block_index.size() * kBlockFloats,
                             tiles[tile].value.begin() + static_cast<long>(first * kBlockFloats)));
    }
  }
}

}  // namespace
}  // namespace rimlight
