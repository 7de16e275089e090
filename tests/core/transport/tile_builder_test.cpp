#include "core/transport/tile_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <thread>
#include <vector>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/math/random.h"
#include "core/transport/transport.h"

namespace rimlight {
namespace {

constexpr std::size_t kColumns = 41;
using Planes = std::vector<float>;
using Block = std::array<float, kBlockReceivers>;

/// Dense planes of all groups; most blocks small, so that every step cuts somewhere.
std::vector<Planes> random_groups(std::uint64_t seed) {
  std::vector<Planes> groups;
  for (std::size_t group = 0; group < TileBuilder::kGroups; ++group) {
    Random random(seed, group);
    Planes& planes = groups.emplace_back(kColumns * kGroupFloats);
    for (std::size_t at = 0; at < planes.size(); at += kBlockReceivers) {
      if (random.uniform() < 0.8) continue;
      const double size = std::pow(10.0, random.uniform(-7, 1));
      for (std::size_t i = 0; i < kBlockReceivers; ++i) {
        planes[at + i] = static_cast<float>(size * random.uniform(-1, 1));
      }
    }
  }
  return groups;
}

TileTransport build(const std::vector<Planes>& groups, const StorageStep& storage) {
  TileBuilder builder(kColumns, storage);
  for (std::size_t group = 0; group < groups.size(); ++group) {
    builder.add_group(group, groups[group]);
  }
  return builder.assemble();
}

Block dense(const std::vector<Planes>& groups, std::size_t column, std::size_t plane,
            std::size_t index) {
  Block block;
  const std::size_t first = column * kGroupFloats + plane * 64 + index % 8 * kBlockReceivers;
  std::copy_n(groups[index / 8].begin() + static_cast<std::ptrdiff_t>(first), kBlockReceivers,
              block.begin());
  return block;
}

/// What a tile holds of one column: [plane, index] to values in the clear.
std::map<std::pair<std::size_t, std::size_t>, Block> clear(const TileTransport& tile,
                                                           std::size_t column) {
  std::map<std::pair<std::size_t, std::size_t>, Block> blocks;
  for (RunCursor at(tile.run(column)); !at.at_end(); at.next()) {
    RunBlock block = at.block();
    for (float& value : block.value) value *= tile.column_step[column];
    EXPECT_TRUE(blocks.emplace(std::pair(block.plane, block.index), block.value).second);
  }
  return blocks;
}

TEST(TileBuilder, KeepsABlockByItsEnergyAndEachNumberWithinHalfAStep) {
  const auto groups = random_groups(1);
  for (const StorageStep storage : {StorageStep{1e-6f, 0}, {1e-4f, 3}, {0.02f, 20}, {1e9f, 3}}) {
    const TileTransport tile = build(groups, storage);
    std::size_t kept = 0, left_out = 0;
    for (std::size_t column = 0; column < kColumns; ++column) {
      ASSERT_EQ(tile.column_step[column], storage.step);
      auto found = clear(tile, column);
      for (std::size_t plane = 0; plane < kPlanes; ++plane) {
        for (std::size_t index = 0; index < kTileBlocks; ++index) {
          const Block expected = dense(groups, column, plane, index);
          const auto block = found.extract(std::pair(plane, index));
          double energy = 0;
          for (const float m : expected) energy += std::pow(std::nearbyint(m / storage.step), 2);
          const double border = 1e-3 * energy;  // m / step rounds otherwise than m · (1 / step)
          if (block.empty()) {
            ++left_out;
            ASSERT_LE(energy - border, std::max(0.0f, storage.least_energy));
            continue;
          }
          ++kept;
          ASSERT_GE(energy + border, storage.least_energy);
          for (std::size_t i = 0; i < kBlockReceivers; ++i) {
            const double m = expected[i];
            const double bound = 0.5 * storage.step * 1.0001 + std::abs(m) * 0x1p-22;
            ASSERT_NEAR(block.mapped()[i], m, bound);
          }
        }
      }
      ASSERT_TRUE(found.empty());
    }
    EXPECT_EQ(kept == 0, storage.step == 1e9f);
    EXPECT_GT(left_out, 1000u);
  }
}

TEST(TileBuilder, TheOrderAndTheThreadsOfGroupsChangeNothing) {
  const auto groups = random_groups(3);
  const TileTransport expected = build(groups, {1e-4f});
  std::vector<std::size_t> order(TileBuilder::kGroups);
  std::iota(order.begin(), order.end(), 0);
  Random random(5);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  TileBuilder builder(kColumns, {1e-4f});
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
  for (Planes& planes : groups) {
    for (std::size_t i = 0; i < planes.size(); i += 3) planes[i] *= 1e-37f;
  }
  TileTransport plain, flushed;
  std::thread([&] { plain = build(groups, {1e-6f}); }).join();
  std::thread([&] {
    flush_denormals();
    flushed = build(groups, {1e-6f});
  }).join();
  EXPECT_EQ(plain, flushed);
}

TEST(TileBuilder, RefusesWhatIsNotFinite) {
  auto groups = random_groups(5);
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity()}) {
    groups[7][100] = bad;
    TileBuilder builder(kColumns, {1});
    EXPECT_THROW(builder.add_group(7, groups[7]), CheckFailure);
  }
}

TEST(Prune, MakesWhatABuilderOfThatLeastEnergyWouldHaveMade) {
  const auto groups = random_groups(6);
  const TileTransport tile = build(groups, {1e-4f, 3});
  EXPECT_EQ(prune(tile, 3), tile);
  EXPECT_EQ(prune(tile, 0), tile);
  std::size_t previous = tile.runs.size();
  for (const float energy : {5.0f, 50.0f, 1e4f}) {
    const TileTransport pruned = prune(tile, energy);
    EXPECT_EQ(pruned, build(groups, {1e-4f, energy}));
    EXPECT_LT(pruned.runs.size(), previous);
    previous = pruned.runs.size();
  }
  EXPECT_TRUE(prune(tile, 1e30f).runs.empty());
}

TEST(Transport, HoldsTheTilesOneAfterAnother) {
  const std::vector<TileTransport> tiles = {build(random_groups(7), {1e-3f, 3}),
                                            build(random_groups(8), {1e-3f, 1e30f}),
                                            build(random_groups(9), {1e-3f, 100})};
  Transport made(tiles);
  const Transport transport = std::move(made);  // the view follows its arrays
  for (std::size_t tile = 0; tile < tiles.size(); ++tile) {
    for (std::size_t column = 0; column < kColumns; ++column) {
      const ColumnRun run = transport.view().run(tile, column);
      ASSERT_TRUE(std::ranges::equal(run.words(), tiles[tile].run(column).words()));
    }
  }
  EXPECT_EQ(transport.view().byte_count(), 8 * (tiles[0].runs.size() + tiles[2].runs.size()));
}

}  // namespace
}  // namespace rimlight
