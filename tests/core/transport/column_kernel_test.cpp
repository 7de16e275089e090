#include "core/transport/column_kernel.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/base/check.h"
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
    // Whole columns, or some layers of one.
    const auto layers = static_cast<LayerSet>(random.below(2) == 0 ? kAllLayers : random.below(8));
    deltas.push_back({column, {value(), value(), value()}, layers});
  }
  return deltas;
}

AlignedVector<float> random_held(std::uint64_t seed) {
  Random random(seed, 5);
  AlignedVector<float> held(kTileFloats);
  for (float& value : held) value = static_cast<float>(random.uniform(-1, 1));
  return held;
}

/// Eight numbers, and how many of them are filled in.
using Block = std::pair<std::array<float, kBlockReceivers>, std::size_t>;

/// One tile with one column of step 1, of these blocks in the luma plane.
Transport one_column(const std::vector<Block>& blocks) {
  RunBuilder builder(0);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    builder.add({0, static_cast<std::uint16_t>(i), blocks[i].first});
  }
  TileTransport tile;
  tile.column_step = {1};
  builder.finish(tile.runs);
  tile.run_offset = {0, static_cast<std::uint32_t>(tile.runs.size())};
  return Transport({&tile, 1});
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
    // A term: delta · factor · step rounds twice, its product once (no FMA), its sum once. Three
    // planes at most add to a number. So four roundings of 2⁻²⁴ for each of 3 terms a column, of
    // the magnitudes added up to there.
    const double bound = 4 * 3 * 0x1p-24 * static_cast<double>(deltas.size());
    for_each_target([&] {
      for (std::size_t tile = 0; tile < 3; ++tile) {
        AlignedVector<float> held = random_held(tile);
        const auto expected = reference::add_columns(transport.view(), tile, deltas, held);
        add_columns(transport.view(), tile, deltas, held.data());
        for (std::size_t i = 0; i < kTileFloats; ++i) {
          const double error = std::abs(held[i] - expected.value[i]);
          worst = std::max(worst, error / expected.magnitude[i] / bound);
          ASSERT_TRUE(error <= bound * expected.magnitude[i]) << tile << " " << i;
        }
      }
    });
  }
  RecordProperty("worst_of_bound", std::to_string(worst));
  EXPECT_GT(worst, 0.0003) << "nothing was added";
}

TEST(ColumnKernel, EveryNumberOfEveryWidthIsAddedExactly) {
  // step 1, delta 1, held 0: what comes out is the number itself, on every target.
  std::vector<Block> blocks;
  const auto add = [&blocks](int value) {
    if (blocks.empty() || blocks.back().second == kBlockReceivers) blocks.push_back({{}, 0});
    blocks.back().first[blocks.back().second++] = static_cast<float>(value);
  };
  for (const int largest : {7, 127, 32767}) {
    for (int value = -largest; value <= largest; ++value) add(value);
    while (blocks.back().second != kBlockReceivers) add(largest);
  }
  for (std::size_t first = 0; first < blocks.size(); first += kTileBlocks) {
    const std::size_t count = std::min(kTileBlocks, blocks.size() - first);
    const Transport transport = one_column({blocks.begin() + static_cast<long>(first),
                                            blocks.begin() + static_cast<long>(first + count)});
    for_each_target([&] {
      AlignedVector<float> held(kTileFloats);
      add_columns(transport.view(), 0, std::vector<ColumnDelta>{{0, {1, 1, 1}}}, held.data());
      for (std::size_t b = 0; b < count; ++b) {
        for (std::size_t i = 0; i < kBlockFloats; ++i) {
          ASSERT_EQ(held[b * kBlockFloats + i], blocks[first + b].first[i % kBlockReceivers]);
        }
      }
    });
  }
}

/// Several sessions' deltas for some of the columns; some are zero.
struct ManyDeltas {
  std::vector<std::uint32_t> columns;
  std::vector<Vec3f> deltas;  // [column][session]

  ManyDeltas(std::size_t column_count, std::size_t sessions) {
    Random random(column_count, sessions);
    for (std::uint32_t column = 0; column < column_count; ++column) {
      if (random.uniform() < 0.3) continue;
      columns.push_back(column);
      for (std::size_t s = 0; s < sessions; ++s) {
        const auto value = [&] { return static_cast<float>(random.uniform(-2, 2)); };
        deltas.push_back(random.uniform() < 0.2 ? Vec3f{} : Vec3f{value(), value(), value()});
      }
    }
  }
  std::vector<ColumnDelta> of_session(std::size_t session) const {
    const std::size_t sessions = deltas.size() / columns.size();
    std::vector<ColumnDelta> result;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      result.push_back({columns[i], deltas[i * sessions + session]});
    }
    return result;
  }
};

TEST(ColumnKernel, SeveralSessionsGetTheBitsThatEachWouldGetAlone) {
  for (const double density : {0.01, 0.3}) {
    const Transport transport =
        random_transport({.tile_count = 2, .column_count = 200, .density = density});
    for (std::size_t sessions = 1; sessions <= 9; ++sessions) {
      const ManyDeltas many(200, sessions);
      ASSERT_GT(many.columns.size(), 130u) << "more than are added at once";
      for_each_target([&] {
        std::vector<AlignedVector<float>> held, alone;
        std::vector<float*> tiles;
        for (std::size_t s = 0; s < sessions; ++s) {
          held.push_back(random_held(s));
          alone.push_back(random_held(s));
          add_columns(transport.view(), 1, many.of_session(s), alone.back().data());
        }
        for (auto& tile : held) tiles.push_back(tile.data());
        add_columns_to_all(transport.view(), 1, {many.columns, many.deltas}, tiles);
        for (std::size_t s = 0; s < sessions; ++s) {
          ASSERT_TRUE(std::ranges::equal(held[s], alone[s])) << s << " of " << sessions;
          ASSERT_NE(held[s], random_held(s)) << "nothing was added";
        }
      });
    }
  }
}

TEST(ColumnKernel, RefusesDeltasThatAreNotOneForEachColumnAndSession) {
  const Transport transport = random_transport({});
  AlignedVector<float> held(kTileFloats), other(kTileFloats);
  const std::vector<float*> tiles = {held.data(), other.data()};
  const std::vector<std::uint32_t> columns = {0, 1};
  const std::vector<Vec3f> deltas(5, Vec3f{1, 1, 1});
  for (const std::size_t count : {0u, 2u, 3u, 5u}) {
    const SessionDeltas wrong = {columns, std::span(deltas).first(count)};
    EXPECT_THROW(add_columns_to_all(transport.view(), 0, wrong, tiles), CheckFailure);
  }
  EXPECT_EQ(held, AlignedVector<float>(kTileFloats));
  add_columns_to_all(transport.view(), 0, {columns, std::span(deltas).first(4)}, tiles);
  EXPECT_NE(held, AlignedVector<float>(kTileFloats));
  EXPECT_EQ(held, other);
  add_columns_to_all(transport.view(), 0, {}, {});  // nothing for no one
}

TEST(ColumnKernel, NoColumnsChangeNothing) {
  const Transport transport = random_transport({});
  const AlignedVector<float> before = random_held(1);
  AlignedVector<float> held = before;
  add_columns(transport.view(), 0, {}, held.data());
  EXPECT_EQ(held, before);
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
  std::set<std::size_t> touched;
  for (RunCursor at(transport.view().run(0, 1)); !at.at_end(); at.next()) {
    touched.insert(at.block().index);
  }
  AlignedVector<float> held(kTileFloats, -0.0f);  // adding +0 would turn it into +0
  add_columns(transport.view(), 0, std::vector<ColumnDelta>{{1, {1, 1, 1}}}, held.data());
  std::size_t untouched = 0;
  for (std::size_t block = 0; block < kTileBlocks; ++block) {
    if (touched.contains(block)) continue;
    ++untouched;
    for (std::size_t i = 0; i < kBlockFloats; ++i) {
      ASSERT_TRUE(std::signbit(held[block * kBlockFloats + i]));
    }
  }
  EXPECT_GT(untouched, 0u);
  EXPECT_LT(untouched, kTileBlocks);
}

}  // namespace
}  // namespace rimlight
