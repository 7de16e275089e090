#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/error.h"
#include "core/image/image_file.h"
#include "core/math/random.h"
#include "tests/core/image/encoded_pictures.h"
#include "tests/support/error_of.h"

namespace rimlight {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using namespace test;  // NOLINT: the makers of pictures

RgbImage decode(const std::string& file) { return decode_hdr(bytes_of(file), "a.hdr"); }
std::string error_of_file(const std::string& file) {
  return error_of([&] { decode(file); });
}

/// RGBE in double: mantissa · 2^(exponent − 136), black for exponent 0. Exact in a float.
void expect_same(const RgbImage& image, const RgbePicture& picture) {
  ASSERT_EQ(image.width, picture.width);
  ASSERT_EQ(image.height, picture.height);
  for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
    const Rgbe& p = picture.pixels[i];
    const double unit = p.e == 0 ? 0 : std::ldexp(1, p.e - 136);
    const Vec3d expected = Vec3d(p.r, p.g, p.b) * unit;
    ASSERT_EQ(Vec3d(image.pixels[i]), expected) << "pixel " << i;
  }
}

TEST(Hdr, EveryPixelIsItsMantissasTimesTheExponent) {
  for (const auto& [width, height] : {std::pair(8, 3), {37, 11}, {300, 5}, {129, 2}}) {
    const RgbePicture picture = random_rgbe(width, height, 1);
    expect_same(decode(hdr_with_runs(picture)), picture);
    expect_same(decode(hdr_flat(picture)), picture);
  }
}

TEST(Hdr, PicturesTooNarrowForRunsAreFlat) {
  for (int width = 1; width < 8; ++width) {
    const RgbePicture picture = random_rgbe(width, 5, 2);
    expect_same(decode(hdr_flat(picture)), picture);
  }
}

TEST(Hdr, EveryTruncationIsAnError) {
  for (const std::string& file :
       {hdr_with_runs(random_rgbe(20, 6, 3)), hdr_flat(random_rgbe(20, 6, 3)),
        hdr_flat(random_rgbe(5, 6, 3))}) {
    ASSERT_EQ(error_of_file(file), "no error");
    for (std::size_t size = 0; size < file.size(); ++size) {
      ASSERT_NE(error_of_file(file.substr(0, size)), "no error") << size << " bytes";
    }
  }
}

TEST(Hdr, ATruncatedRowIsNamed) {
  const std::string file = hdr_with_runs(random_rgbe(20, 6, 3));
  EXPECT_THAT(error_of_file(file.substr(0, file.size() - 1)),
              AllOf(HasSubstr("a.hdr: row 5"), HasSubstr("the end of the file")));
}

// stb_image takes the endless zeros behind the end for empty runs, and waits for ever.
TEST(Hdr, AnEmptyRunIsRefused) {
  std::string file = hdr_header("-Y 1 +X 8") + std::string{2, 2, 0, 8};
  file += std::string(64, '\0');
  EXPECT_THAT(error_of_file(file), HasSubstr("a run of 0 pixels"));
}

TEST(Hdr, ARunBeyondTheRowIsRefused) {
  const std::string file =
      hdr_header("-Y 1 +X 8") + std::string{2, 2, 0, 8, static_cast<char>(128 + 9), 1};
  EXPECT_THAT(error_of_file(file),
              AllOf(HasSubstr("a run of 9 pixels"), HasSubstr("1 to 8 pixels")));
}

TEST(Hdr, AClaimThatIsTooLargeIsRefusedBeforeAnyPixelIsRead) {
  EXPECT_THAT(error_of_file(hdr_header("-Y 100000 +X 100000")),
              AllOf(HasSubstr("100000 × 100000"), HasSubstr("16384")));
  for (const char* const size :
       {"-Y 16385 +X 1", "-Y 1 +X 16385", "-Y 0 +X 8", "-Y 8 +X 0", "-Y -8 +X 8", "-Y 8 +X -8",
        "-Y 4294967304 +X 8", "-Y 9223372036854775807 +X 9223372036854775807"}) {
    EXPECT_THAT(error_of_file(hdr_header(size) + std::string(256, 'a')), HasSubstr("an image of"))
        << size;
  }
}

TEST(Hdr, OtherLayoutsAreNamed) {
  for (const char* const size : {"+Y 8 +X 8", "+X 8 -Y 8", "-Y 8", "-Y 8 +X", "-Y 8 +X 8 ",
                                 "-Y 99999999999999999999 +X 8", "nonsense", "-Y +8 +X 8"}) {
    EXPECT_THAT(error_of_file(hdr_header(size) + std::string(256, 'a')), HasSubstr("the size"))
        << size;
  }
}

TEST(Hdr, BrokenHeadersSayWhatIsMissing) {
  EXPECT_THAT(error_of_file(""), HasSubstr("another format"));
  EXPECT_THAT(error_of_file("\x89PNG\r\n"), HasSubstr("another format"));
  EXPECT_THAT(error_of_file("#?RADIANCE\n\n-Y 1 +X 1\n"), HasSubstr("FORMAT"));
  EXPECT_THAT(error_of_file("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\nabcd"),
              HasSubstr("32-bit_rle_rgbe"));
  EXPECT_THAT(error_of_file("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n"), HasSubstr("truncated header"));
  EXPECT_THAT(error_of_file(std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\0\n\n", 36)),
              HasSubstr("zero byte"));
}

TEST(Hdr, ARowOfAnotherLengthIsRefused) {
  std::string file = hdr_header("-Y 2 +X 8");
  for (const char length : {'\x08', '\x09'}) {
    file += {2, 2, 0, length};
    for (int c = 0; c < 4; ++c) file += {static_cast<char>(128 + length), 1};
  }
  EXPECT_THAT(error_of_file(file), HasSubstr("a.hdr: row 1"));
}

TEST(Hdr, FlippedBytesGiveAnErrorOrAPictureOfTheClaimedSize) {
  const std::string whole = hdr_with_runs(random_rgbe(24, 5, 4));
  Random random(5);
  int refused = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    std::string file = whole;
    for (std::uint64_t flips = 1 + random.below(3); flips > 0; --flips) {
      file[random.below(file.size())] = static_cast<char>(random.below(256));
    }
    try {
      const RgbImage image = decode(file);
      ASSERT_EQ(image.pixels.size(),
                static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
      for (const Vec3f& pixel : image.pixels) ASSERT_TRUE(is_finite(pixel));
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace rimlight
