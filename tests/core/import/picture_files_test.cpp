// Which pictures go with which directions, and masks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/image/codec.h"
#include "core/image/image_file.h"
#include "core/import/coverage_mask.h"
#include "core/import/picture_files.h"
#include "tests/support/error_of.h"
#include "tests/support/overwrite.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

DirectionList list_of(std::size_t count, std::vector<std::string> images = {}) {
  DirectionList list;
  list.source = "lights.txt";
  list.directions.assign(count, Vec3d(0, 1, 0));
  list.images = std::move(images);
  return list;
}

TEST(PictureFiles, NumbersInNamesCountAsNumbers) {
  const std::vector<std::string> sorted = {"",
                                           "9",
                                           "10",
                                           "a",
                                           "a1",
                                           "a01b",
                                           "a2",
                                           "a2_9",
                                           "a2_10",
                                           "a10",
                                           "a99999999999999999998",
                                           "a99999999999999999999",
                                           "ab",
                                           "b1"};
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    for (std::size_t j = 0; j < sorted.size(); ++j) {
      EXPECT_EQ(comes_before(sorted[i], sorted[j]), i < j) << sorted[i] << " " << sorted[j];
    }
  }
  EXPECT_NE(comes_before("a1", "a01"), comes_before("a01", "a1"));
}

TEST(PictureFiles, AFoldersPicturesGoByTheirNames) {
  const test::TemporaryFolder folder;
  for (const char* name : {"l10.exr", "l2.EXR", "l1.png", "notes.txt", "mask.png"}) {
    test::overwrite(folder / name, "");
  }
  EXPECT_THAT(find_pictures({folder.path()}, list_of(3), folder / "mask.png"),
              ElementsAre(folder / "l1.png", folder / "l2.EXR", folder / "l10.exr"));
  const std::string error = test::error_of([&] { find_pictures({folder.path()}, list_of(3)); });
  EXPECT_THAT(error,
              HasSubstr("found 4 pictures, expected 3, one for each direction of lights.txt"));
}

TEST(PictureFiles, NamesInTheListDecide) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(find_pictures({folder.path()}, list_of(2, {"b.exr", "sub/a.png"})),
              ElementsAre(folder / "b.exr", folder / "sub/a.png"));
  EXPECT_THAT(test::error_of([&] {
                find_pictures({"a.exr", "b.exr"}, list_of(2, {"b.exr", "a.exr"}));
              }),
              HasSubstr("lights.txt: found names of images"));
}

TEST(PictureFiles, GivenPicturesKeepTheirOrder) {
  EXPECT_THAT(find_pictures({"b.exr", "a.exr"}, list_of(2)),
              ElementsAre(fs::path("b.exr"), fs::path("a.exr")));
  EXPECT_THAT(test::error_of([&] { find_pictures({"a.exr"}, list_of(2)); }),
              HasSubstr("a.exr: found 1 pictures, expected 2"));
}

TEST(CoverageMask, ReadsBytesAndFloats) {
  const test::TemporaryFolder folder;
  Rgb8Image bytes(40, 1);
  bytes.bytes[0] = 51;
  bytes.bytes[3] = 255;
  std::vector<std::uint8_t> png;
  encode_png(bytes, png);
  test::overwrite(folder / "m.png", {reinterpret_cast<const char*>(png.data()), png.size()});
  const auto shares = read_mask(folder / "m.png").shares;
  ASSERT_EQ(shares.size(), 40u);
  EXPECT_EQ(shares[0], 0.2f);
  EXPECT_EQ(shares[1], 1.0f);
  EXPECT_EQ(shares[2], 0.0f);
  RgbImage floats(1, 3);
  floats.at(0, 0) = {0.5f, 0, 0};
  floats.at(0, 1) = {7, 0, 0};
  floats.at(0, 2) = {-1, 1, 1};
  write_exr(folder / "m.exr", floats);
  const CoverageMask mask = read_mask(folder / "m.exr");
  EXPECT_EQ(mask.height, 3);
  EXPECT_THAT(mask.shares, ElementsAre(0.5f, 1.0f, 0.0f));
  test::overwrite(folder / "m.gif", "GIF");
  EXPECT_THAT(test::error_of([&] { read_mask(folder / "m.gif"); }), HasSubstr("m.gif"));
}

}  // namespace
}  // namespace rimlight
