#include "core/bake/reference_output.h"

#include <gtest/gtest.h>

#include "core/base/files.h"
#include "core/transport/reference_rows.h"
#include "tests/support/ball_source.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using test::BallSource;
using test::TemporaryFolder;

TEST(ReferenceOutput, KeepsWhatTheSourceGivesBitForBitAndChangesNothingElse) {
  const TemporaryFolder folder;
  const BallSource source(64, 4);
  bake_ball(folder / "plain.bake", source, 0);
  bake_ball(folder / "kept.bake", source, 5 * 64 - 10);  // five groups, rounded up
  const Bake bake(folder / "kept.bake");
  const TensorFile* const file = bake.find_file(kReferenceFile);
  ASSERT_NE(file, nullptr);
  const auto groups = file->tensor<std::uint64_t>("first_receiver", ElementType::u64);
  const auto rows = file->tensor<float>("rows", ElementType::f32);
  ASSERT_EQ(groups.size(), 5u);
  BakedGroup group(source.cube_size());
  const std::size_t each = group.coefficients.values.size();
  ASSERT_EQ(rows.size(), 5 * each);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    EXPECT_TRUE(source.has_receivers(groups[i]));
    source.find_rows(groups[i], group);
    EXPECT_TRUE(std::equal(rows.begin() + static_cast<std::ptrdiff_t>(i * each),
                           rows.begin() + static_cast<std::ptrdiff_t>((i + 1) * each),
                           group.coefficients.values.begin()));
  }
  for (const char* const name : {"transport.safetensors", "pixels.safetensors"}) {
    EXPECT_EQ(read_file(folder / "plain.bake" / name, SIZE_MAX),
              read_file(folder / "kept.bake" / name, SIZE_MAX));
  }
  EXPECT_EQ(Bake(folder / "plain.bake").find_file(kReferenceFile), nullptr);
}

TEST(ReferenceOutput, KeepsAllGroupsOfASmallPicture) {
  const TemporaryFolder folder;
  const BallSource source(24, 4);
  bake_ball(folder / "a.bake", source, 8192);
  const Bake bake(folder / "a.bake");
  std::size_t expected = 0;
  for (std::size_t first = 0; first < kTileReceivers; first += 64) {
    expected += source.has_receivers(first);
  }
  EXPECT_GT(expected, 4u);
  EXPECT_EQ(ReferenceRows::open(bake)->groups().size(), expected);
}

}  // namespace
}  // namespace rimlight
