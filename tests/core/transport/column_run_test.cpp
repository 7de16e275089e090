#include "core/transport/column_run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <vector>

#include "core/base/check.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

using Words = std::vector<std::uint64_t>;
using Value = std::array<float, kBlockReceivers>;

Words words_of(const std::vector<RunBlock>& blocks, float least_energy = 0) {
  RunBuilder builder(least_energy);
  for (const RunBlock& block : blocks) builder.add(block);
  Words words;
  builder.finish(words);
  return words;
}

std::vector<RunBlock> blocks_of(const Words& words) {
  std::vector<RunBlock> blocks;
  for (RunCursor at{ColumnRun(words)}; !at.at_end(); at.next()) blocks.push_back(at.block());
  return blocks;
}

/// Blocks of every width in every plane, whole numbers.
std::vector<RunBlock> random_blocks(std::uint64_t seed) {
  Random random(seed);
  std::vector<RunBlock> blocks;
  for (std::size_t plane = 0; plane < kPlanes; ++plane) {
    for (std::uint16_t index = 0; index < kTileBlocks; ++index) {
      if (random.uniform() < 0.7) continue;
      RunBlock block{plane, index, {}};
      const double size = std::pow(10.0, random.uniform(0.3, 6));
      for (float& value : block.value) {
        value = static_cast<float>(std::floor(size * random.uniform(-1, 1)));
      }
      block.value[random.below(8)] = static_cast<float>(std::floor(size));
      blocks.push_back(block);
    }
  }
  return blocks;
}

TEST(ColumnRun, HoldsEachBlockInTheNarrowestWidthThatTakesIt) {
  const auto blocks = random_blocks(1);
  const Words words = words_of(blocks);
  const ColumnRun run(words);
  EXPECT_EQ(find_run_fault(words), nullptr);
  ASSERT_EQ(run.block_count(), blocks.size());
  std::map<std::pair<std::size_t, std::uint16_t>, Value> expected;
  std::array<std::size_t, kWidths> by_width{};
  for (const RunBlock& block : blocks) {
    expected[{block.plane, block.index}] = block.value;
    float largest = 0;
    for (const float value : block.value) largest = std::max(largest, std::abs(value));
    ++by_width[largest <= 7 ? 3 : largest <= 127 ? 2 : largest <= 32767 ? 1 : 0];
  }
  for (const RunBlock& block : blocks_of(words)) {
    const auto found = expected.extract({block.plane, block.index});
    ASSERT_FALSE(found.empty());
    ASSERT_EQ(block.value, found.mapped());
  }
  EXPECT_TRUE(expected.empty());
  std::size_t bytes = 0;
  for (std::size_t width = 0; width < kWidths; ++width) {
    std::size_t count = 0;
    for (std::size_t plane = 0; plane < kPlanes; ++plane) {
      count += run.section_count(static_cast<ValueWidth>(width), plane);
    }
    EXPECT_EQ(count, by_width[width]) << width;
    EXPECT_GT(count, 0u);
    bytes += count * (kBlockBytes[width] + 2);
  }
  EXPECT_EQ(words.size(), 3 + (bytes + 7) / 8);
}

TEST(ColumnRun, WidthsEndWhereTheirNumbersDo) {
  const std::vector<std::pair<float, ValueWidth>> cases = {
      {7, ValueWidth::nibble},     {-7, ValueWidth::nibble},   {7.49f, ValueWidth::nibble},
      {7.5f, ValueWidth::byte},    {8, ValueWidth::byte},      {-8, ValueWidth::byte},
      {127.49f, ValueWidth::byte}, {127.5f, ValueWidth::word}, {-128, ValueWidth::word},
      {32767, ValueWidth::word},   {-32768, ValueWidth::full}, {1e30f, ValueWidth::full}};
  for (const auto& [value, width] : cases) {
    const Words words = words_of({{1, 3, {value}}});
    EXPECT_EQ(ColumnRun(words).section_count(width, 1), 1u) << value;
    const float found = blocks_of(words)[0].value[0];
    EXPECT_EQ(found, std::nearbyint(value)) << value;
  }
}

TEST(ColumnRun, EveryNumberOfANarrowWidthComesBackAtEveryPlace) {
  for (int value = -127; value <= 127; ++value) {
    for (std::size_t place = 0; place < kBlockReceivers; ++place) {
      RunBlock block{2, 511, {}};
      block.value.fill(static_cast<float>(-value % 5));
      block.value[place] = static_cast<float>(value);
      const auto found = blocks_of(words_of({block}));
      if (block.value == Value{}) {
        ASSERT_TRUE(found.empty());
      } else {
        ASSERT_EQ(found.at(0).value, block.value) << value << " " << place;
      }
    }
  }
}

TEST(ColumnRun, ABlockIsLeftOutByTheEnergyOfItsRoundedNumbers) {
  const RunBlock block{0, 5, {1.4f, -1.4f, 0.4f, 0.6f}};  // rounds to 1, −1, 0, 1
  EXPECT_EQ(blocks_of(words_of({block}, 3)).size(), 1u);
  EXPECT_EQ(blocks_of(words_of({block}, 3.01f)).size(), 0u);
  EXPECT_TRUE(words_of({{0, 5, {0.4f, -0.3f}}}, 0).empty()) << "zeros are never stored";
  EXPECT_TRUE(words_of({}).empty());
}

TEST(ColumnRun, RoundsToTheNearestTiesToEven) {
  Random random(9);
  for (int i = 0; i < 100'000; ++i) {
    const auto value =
        static_cast<float>(std::ldexp(random.uniform(-1, 1), static_cast<int>(random.below(23))));
    ASSERT_EQ(round_to_whole(value), std::nearbyint(value)) << value;
  }
  for (const float value : {0.5f, 1.5f, 2.5f, -0.5f, -1.5f, 4194303.5f, 0.0f}) {
    ASSERT_EQ(round_to_whole(value), std::nearbyint(value)) << value;
  }
}

TEST(ColumnRun, RefusesWhatIsNotFiniteOrOutOfOrder) {
  RunBuilder builder(0);
  EXPECT_THROW(builder.add({0, 1, {std::numeric_limits<float>::quiet_NaN()}}), CheckFailure);
  EXPECT_THROW(builder.add({0, 1, {std::numeric_limits<float>::infinity()}}), CheckFailure);
  EXPECT_THROW(builder.add({3, 1, {1}}), CheckFailure);
  EXPECT_THROW(builder.add({0, 512, {1}}), CheckFailure);
  builder.add({0, 9, {1}});
  EXPECT_THROW(builder.add({0, 9, {1}}), CheckFailure);
  builder.add({1, 9, {1}});
}

TEST(ColumnRun, WordsOfAnyKindAreJudgedWithoutHarm) {
  const Words good = words_of(random_blocks(4));
  Random random(5);
  std::size_t refused = 0;
  for (int i = 0; i < 20'000; ++i) {
    Words bad = good;
    auto* const bytes = reinterpret_cast<std::uint8_t*>(bad.data());
    const std::size_t at = random.below(i % 2 == 0 ? 24 : 8 * bad.size());
    bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ (1u << random.below(8)));
    if (i % 16 == 0) bad.resize(random.below(bad.size()));
    if (find_run_fault(bad) != nullptr) {
      ++refused;
    } else {  // then walking over it is safe
      for (const RunBlock& block : blocks_of(bad)) {
        ASSERT_LT(block.index, kTileBlocks);
        for (const float value : block.value) ASSERT_TRUE(std::isfinite(value));
      }
    }
  }
  EXPECT_GT(refused, 10'000u);
  const Words short_run(2);
  EXPECT_NE(find_run_fault(short_run), nullptr);
  EXPECT_EQ(find_run_fault({}), nullptr);
}

TEST(ColumnRun, ATwiceNamedBlockAndAnInfinityAreFaults) {
  Words words = words_of({{0, 4, {1}}, {0, 9, {1}}});
  auto* index = const_cast<std::uint16_t*>(ColumnRun(words).indices());
  index[1] = 4;
  EXPECT_STREQ(find_run_fault(words), "block indices out of order");
  index[1] = 512;
  EXPECT_STREQ(find_run_fault(words), "block indices out of order");
  words = words_of({{0, 4, {1e20f}}});
  const float bad = std::numeric_limits<float>::infinity();
  std::memcpy(words.data() + ColumnRun::kHeaderWords, &bad, sizeof bad);
  EXPECT_STREQ(find_run_fault(words), "an infinity or NaN");
}

}  // namespace
}  // namespace rimlight
