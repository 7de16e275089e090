#include "core/transport/transport.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "tests/support/random_transport.h"

namespace rimlight {
namespace {

TEST(MeasureParts, CountsWhatEachLayerOfAColumnHas) {
  constexpr std::size_t kColumns = 60, kTiles = 3;
  const Transport transport = test::random_transport(
      {.tile_count = kTiles, .column_count = kColumns, .density = 0.004, .seed = 9});
  const std::vector<PartSize> sizes = measure_parts(transport.view());
  const std::vector<std::uint32_t> bytes = count_column_bytes(transport.view());
  ASSERT_EQ(sizes.size(), kColumns * kLayers);
  std::size_t empty = 0;
  for (std::size_t column = 0; column < kColumns; ++column) {
    std::array<PartSize, kLayers> expected{};
    std::size_t of_runs = 0;
    for (std::size_t tile = 0; tile < kTiles; ++tile) {
      std::array<std::uint32_t, kLayers> blocks{}, numbers{};
      const ColumnRun run = transport.view().run(tile, column);
      of_runs += run.words().size_bytes();
      for (RunCursor at(run); !at.at_end(); at.next()) {
        const std::size_t layer = at.width() == ValueWidth::nibble ? 2
                                  : at.width() == ValueWidth::byte ? 1
                                                                   : 0;
        ++blocks[layer];
        numbers[layer] +=
            static_cast<std::uint32_t>(kBlockBytes[static_cast<std::size_t>(at.width())]);
      }
      for (std::size_t layer = 0; layer < kLayers; ++layer) {
        if (blocks[layer] == 0) continue;
        const std::uint32_t unpadded = 24 + numbers[layer] + 2 * blocks[layer];
        expected[layer].bytes += (unpadded + 7) / 8 * 8;
        expected[layer].blocks += blocks[layer];
        ++expected[layer].runs;
      }
    }
    std::size_t of_layers = 0;
    for (std::size_t layer = 0; layer < kLayers; ++layer) {
      const PartSize& found = sizes[part_of(column, layer)];
      EXPECT_EQ(found.bytes, expected[layer].bytes);
      EXPECT_EQ(found.blocks, expected[layer].blocks);
      EXPECT_EQ(found.runs, expected[layer].runs);
      empty += found.blocks == 0;
      of_layers += found.bytes;
    }
    EXPECT_EQ(bytes[column], of_runs);
    EXPECT_GE(of_layers, of_runs) << "a budget of layers' bytes holds for whole columns";
  }
  EXPECT_GT(empty, 0u) << "no layer was without blocks";
}

}  // namespace
}  // namespace rimlight
