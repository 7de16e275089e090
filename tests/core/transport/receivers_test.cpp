#include "core/transport/receivers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

namespace rimlight {
namespace {

const std::vector<PixelLayout> kLayouts = {{64, 64}, {128, 64}, {1, 1}, {65, 63}, {200, 130}};

TEST(PixelLayout, EveryPixelHasAReceiverOfItsOwnAndComesBack) {
  for (const PixelLayout& layout : kLayouts) {
    std::set<std::size_t> used;
    for (int y = 0; y < layout.height; ++y) {
      for (int x = 0; x < layout.width; ++x) {
        const std::size_t receiver = layout.receiver(x, y);
        ASSERT_LT(receiver, layout.receiver_count());
        ASSERT_TRUE(used.insert(receiver).second) << x << " " << y;
        ASSERT_EQ(layout.pixel(receiver).x, x);
        ASSERT_EQ(layout.pixel(receiver).y, y);
      }
    }
    EXPECT_EQ(used.size(), static_cast<std::size_t>(layout.width * layout.height));
  }
}

TEST(PixelLayout, ReceiversThatAreNoPixelLieOutsideTheImage) {
  for (const PixelLayout& layout : kLayouts) {
    std::size_t inside = 0;
    for (std::size_t receiver = 0; receiver < layout.receiver_count(); ++receiver) {
      const auto pixel = layout.pixel(receiver);
      inside += pixel.x < layout.width && pixel.y < layout.height;
    }
    EXPECT_EQ(inside, static_cast<std::size_t>(layout.width * layout.height));
  }
}

/// The box around a run of receivers.
struct Box {
  int width, height, left, top;
};
Box box_of(const PixelLayout& layout, std::size_t first, std::size_t count) {
  int left = 1 << 20, right = -1, top = 1 << 20, bottom = -1;
  for (std::size_t i = first; i < first + count; ++i) {
    const auto pixel = layout.pixel(i);
    left = std::min(left, pixel.x), right = std::max(right, pixel.x);
    top = std::min(top, pixel.y), bottom = std::max(bottom, pixel.y);
  }
  return {right - left + 1, bottom - top + 1, left, top};
}

TEST(PixelLayout, TilesGroupsAndBlocksAreTheBoxesThatTheHeaderSays) {
  const PixelLayout layout{200, 130};
  for (std::size_t first = 0; first < layout.receiver_count(); first += kBlockReceivers) {
    const Box block = box_of(layout, first, kBlockReceivers);
    ASSERT_EQ(block.width, 4);
    ASSERT_EQ(block.height, 2);
  }
  for (std::size_t first = 0; first < layout.receiver_count();
       first += PixelLayout::kGroupReceivers) {
    const Box group = box_of(layout, first, PixelLayout::kGroupReceivers);
    ASSERT_EQ(group.width, 8);
    ASSERT_EQ(group.height, 8);
    const std::size_t place = first % kTileReceivers / PixelLayout::kGroupReceivers;
    ASSERT_EQ(group.left % 64 / 8, static_cast<int>(place % 8));
    ASSERT_EQ(group.top % 64 / 8, static_cast<int>(place / 8));
  }
  for (std::size_t tile = 0; tile < layout.tile_count(); ++tile) {
    const Box box = box_of(layout, tile * kTileReceivers, kTileReceivers);
    EXPECT_EQ(box.width, 64);
    EXPECT_EQ(box.height, 64);
    EXPECT_EQ(box.left / 64 + box.top / 64 * 4, static_cast<int>(tile));
  }
}

TEST(ReceiverValues, AreZeroWhenMadeAndAtFindsTheLane) {
  ReceiverValues values(2);
  EXPECT_EQ(values.tile_count(), 2u);
  for (std::size_t i = 0; i < 2 * kTileReceivers; ++i) ASSERT_EQ(values.at(i), Vec3f());
  values.tile(1)[3 * kBlockFloats + 2 * kBlockReceivers + 5] = 7;
  const std::size_t receiver = kTileReceivers + 3 * kBlockReceivers + 5;
  EXPECT_EQ(values.at(receiver), Vec3f(0, 0, 7));
  values.set(receiver, {1, 2, 3});
  EXPECT_EQ(values.at(receiver), Vec3f(1, 2, 3));
  EXPECT_EQ(values.at(receiver - 1), Vec3f());
}

}  // namespace
}  // namespace rimlight
