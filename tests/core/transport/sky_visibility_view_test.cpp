// What surfaces see of the sky, packed and unpacked.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/base/check.h"
#include "core/basis/cube_map.h"
#include "core/transport/curve_receivers.h"
#include "tests/support/small_curve_bake.h"

namespace rimlight {
namespace {

using Fifths = std::vector<std::uint8_t>;
using test::random_fifths;

Fifths unpacked(const SkyVisibilityView& view, std::size_t surface) {
  Fifths result(cube::texel_count(view.cube_size), 99);
  view.unpack(surface, result);
  return result;
}

TEST(SkyVisibilityView, GivesBackTheFifthsOfEverySurface) {
  for (const int cube_size : {8, 16, 64}) {
    SkyVisibilityPacker packer(cube_size);
    std::vector<Fifths> all;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      all.push_back(random_fifths(cube_size, seed));
      packer.add(all.back());
    }
    // Nothing in blocks: a number of its own for each texel, so that none stands in another's
    // place.
    Fifths mixed(cube::texel_count(cube_size));
    for (std::size_t i = 0; i < mixed.size(); ++i)
      mixed[i] = static_cast<std::uint8_t>((i * i / 7 + i) % 6);
    all.push_back(mixed);
    packer.add(mixed);
    ASSERT_EQ(packer.view().surface_count(), all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      ASSERT_EQ(unpacked(packer.view(), i), all[i]) << cube_size << " " << i;
    }
  }
}

TEST(SkyVisibilityView, OnlyBlocksOfSomeOfBothTakeRoom) {
  constexpr int kSize = 16;
  SkyVisibilityPacker packer(kSize);
  const std::size_t texels = cube::texel_count(kSize);
  packer.add(Fifths(texels, SkyVisibilityView::kAll));
  packer.add(Fifths(texels, 0));
  EXPECT_EQ(packer.view().mixed.size(), 0u);
  Fifths one(texels, 0);
  one[texels - 1] = 1;
  packer.add(one);
  packer.add(Fifths(texels, 4));  // the same everywhere, but neither all nor nothing
  const SkyVisibilityView view = packer.view();
  EXPECT_EQ(view.blocks_per_surface(), 24u);
  EXPECT_EQ(view.mixed.size(), 25u);
  EXPECT_EQ(view.first_mixed[3], 1u);
  EXPECT_EQ(unpacked(view, 0), Fifths(texels, SkyVisibilityView::kAll));
  EXPECT_EQ(unpacked(view, 1), Fifths(texels, 0));
  EXPECT_EQ(unpacked(view, 2), one);
  EXPECT_EQ(unpacked(view, 3), Fifths(texels, 4));
}

TEST(SkyVisibilityPacker, AppendedSurfacesAreAsIfAddedOneByOne) {
  constexpr int kSize = 8;
  SkyVisibilityPacker first(kSize), second(kSize), together(kSize);
  for (std::uint64_t seed = 0; seed < 7; ++seed) {
    (seed < 3 ? first : second).add(random_fifths(kSize, seed));
    together.add(random_fifths(kSize, seed));
  }
  first.append(second);
  first.append(SkyVisibilityPacker(kSize));
  const SkyVisibilityView view = first.view(), expected = together.view();
  EXPECT_TRUE(std::ranges::equal(view.blocks, expected.blocks));
  EXPECT_TRUE(std::ranges::equal(view.first_mixed, expected.first_mixed));
  EXPECT_TRUE(std::ranges::equal(view.mixed, expected.mixed));
  EXPECT_EQ(unpacked(view, 6), random_fifths(kSize, 6));
}

TEST(SkyVisibilityPacker, WhatIsNoFifthsIsABug) {
  EXPECT_THROW(SkyVisibilityPacker(4), CheckFailure);
  EXPECT_THROW(SkyVisibilityPacker(12), CheckFailure);
  SkyVisibilityPacker packer(8);
  EXPECT_THROW(packer.add(Fifths(cube::texel_count(16))), CheckFailure);
  Fifths six(cube::texel_count(8));
  six[77] = 6;
  EXPECT_THROW(packer.add(six), CheckFailure);
  EXPECT_THROW(packer.append(SkyVisibilityPacker(16)), CheckFailure);
  SkyVisibilityPacker good(8);
  good.add(Fifths(cube::texel_count(8)));
  Fifths room(cube::texel_count(8));
  EXPECT_THROW(good.view().unpack(1, room), CheckFailure);
}

}  // namespace
}  // namespace rimlight
