#include "core/bake/surroundings.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdlib>
#include <vector>

#include "core/base/check.h"
#include "core/math/random.h"

namespace rimlight {
namespace {

/// The lane's pixel in its group, from the layout itself.
PixelLayout::Pixel pixel_of(std::size_t lane) {
  return PixelLayout{PixelLayout::kTileSide, PixelLayout::kTileSide}.pixel(lane);
}

bool beside(std::size_t a, std::size_t b) {
  const PixelLayout::Pixel p = pixel_of(a), q = pixel_of(b);
  return a != b && std::abs(p.x - q.x) <= 1 && std::abs(p.y - q.y) <= 1;
}

TEST(LanesBeside, OfOneLaneAreItsNeighboursInTheLayout) {
  std::size_t pairs = 0;
  for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
    LaneSet expected = 0;
    for (std::size_t other = 0; other < kGroupLanes; ++other) {
      if (beside(lane, other)) expected |= lane_bit(other);
    }
    EXPECT_EQ(lanes_beside(lane_bit(lane)), expected) << lane;
    pairs += static_cast<std::size_t>(std::popcount(expected));
  }
  EXPECT_EQ(pairs, 4 * 3u + 24 * 5u + 36 * 8u);  // corners, borders, the inside of 8×8
}

TEST(LanesBeside, OfASetAreThoseOfItsMembers) {
  Random random(1);
  for (int round = 0; round < 200; ++round) {
    const LaneSet set = random.bits() & random.bits() & random.bits();
    LaneSet expected = 0;
    for_each_lane(set, [&](std::size_t lane) { expected |= lanes_beside(lane_bit(lane)); });
    EXPECT_EQ(lanes_beside(set), expected);
  }
  EXPECT_EQ(lanes_beside(0), 0u);
  EXPECT_EQ(lanes_beside(~LaneSet{0}), ~LaneSet{0});
}

/// Whether `plane` has an answer around (texel, lane), one place after the other.
bool any_around(const std::vector<LaneSet>& plane, int size, std::size_t texel, std::size_t lane) {
  const int face = static_cast<int>(texel) / (size * size);
  const int row = static_cast<int>(texel) / size % size, column = static_cast<int>(texel) % size;
  bool any = false;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      if (std::abs(y - row) > 1 || std::abs(x - column) > 1 || (y == row && x == column)) continue;
      const auto other = static_cast<std::size_t>((face * size + y) * size + x);
      any |= (plane[other] & lane_bit(lane)) != 0;
    }
  }
  for (std::size_t other = 0; other < kGroupLanes; ++other) {
    any |= beside(lane, other) && (plane[texel] & lane_bit(other)) != 0;
  }
  return any;
}

/// Few answers, so that both agreement and disagreement are common.
std::vector<LaneSet> sparse_plane(std::size_t count, Random& random) {
  std::vector<LaneSet> plane(count);
  for (LaneSet& lanes : plane) {
    lanes = random.bits() & random.bits() & random.bits() & random.bits();
  }
  return plane;
}

TEST(Surroundings, AreMixedWhereABruteForceFindsBothAnswers) {
  Random random(2);
  for (const int size : {1, 2, 3, 8}) {
    const std::size_t count = cube::texel_count(size);
    const auto lit = sparse_plane(count, random), dark = sparse_plane(count, random);
    std::vector<LaneSet> mixed(count, random.bits());
    find_mixed_surroundings(size, lit, dark, mixed);
    int yes = 0, no = 0;
    for (std::size_t texel = 0; texel < count; ++texel) {
      for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
        const bool expected =
            any_around(lit, size, texel, lane) && any_around(dark, size, texel, lane);
        ASSERT_EQ((mixed[texel] & lane_bit(lane)) != 0, expected) << size << " " << texel;
        ++(expected ? yes : no);
      }
    }
    EXPECT_GT(yes, 10);
    EXPECT_GT(no, 10);
  }
}

TEST(Surroundings, DoNotHearATexelsOwnAnswer) {
  constexpr int kSize = 4;
  const std::size_t count = cube::texel_count(kSize);
  Random random(3);
  const auto lit = sparse_plane(count, random), dark = sparse_plane(count, random);
  std::vector<LaneSet> before(count), after(count);
  find_mixed_surroundings(kSize, lit, dark, before);
  for (int round = 0; round < 100; ++round) {
    const std::size_t texel = random.below(count);
    const LaneSet lane = lane_bit(random.below(kGroupLanes));
    auto changed_lit = lit, changed_dark = dark;
    changed_lit[texel] ^= lane;
    changed_dark[texel] ^= lane;
    find_mixed_surroundings(kSize, changed_lit, changed_dark, after);
    EXPECT_EQ(before[texel] & lane, after[texel] & lane);
  }
}

TEST(Surroundings, SizesThatDisagreeAreBugs) {
  std::vector<LaneSet> plane(24), small(23);
  EXPECT_THROW(find_mixed_surroundings(2, plane, plane, small), CheckFailure);
  EXPECT_THROW(find_mixed_surroundings(2, small, plane, plane), CheckFailure);
}

}  // namespace
}  // namespace rimlight
