#include <ImfChannelList.h>
#include <ImfStdIO.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <climits>
#include <cstring>

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

RgbImage decode(const std::string& file) { return decode_exr(bytes_of(file), "a.exr"); }
std::string error_of_file(const std::string& file) {
  return error_of([&] { decode(file); });
}

Imf::Header header_of(int width, int height, Imf::Compression compression = Imf::ZIP_COMPRESSION) {
  Imf::Header header(width, height);
  header.compression() = compression;
  return header;
}

Imf::Header tiled(Imf::Header header, unsigned width, unsigned height) {
  header.setTileDescription(Imf::TileDescription(width, height, Imf::ONE_LEVEL));
  return header;
}

std::string float_file(const RgbImage& image, const Imf::Header& header) {
  return exr_file(header, rgb_channels(image, Imf::FLOAT));
}

/// Where an attribute's value starts; its four bytes of size lie before it.
std::size_t value_place(const std::string& file, const std::string& name, const std::string& type) {
  const std::size_t at = file.find(name + '\0' + type + '\0');
  EXPECT_NE(at, std::string::npos) << name;
  return at + name.size() + type.size() + 2 + 4;
}

void put(std::string& file, std::size_t at, std::int32_t value) {
  std::memcpy(file.data() + at, &value, sizeof value);
}

TEST(Exr, EveryCompressionOfFloatsAndTheTilesGiveTheSamePixels) {
  const RgbImage image = random_image(53, 37, 1);
  for (const Imf::Compression compression :
       {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION,
        Imf::PIZ_COMPRESSION}) {
    const Imf::Header header = header_of(53, 37, compression);
    EXPECT_EQ(decode(float_file(image, header)).pixels, image.pixels) << compression;
    EXPECT_EQ(decode(float_file(image, tiled(header, 16, 8))).pixels, image.pixels) << compression;
  }
}

TEST(Exr, HalvesAndWholeNumbersAreRead) {
  RgbImage image = random_image(19, 5, 2);
  for (Vec3f& pixel : image.pixels) {
    for (int c = 0; c < 3; ++c) pixel[c] = std::floor(pixel[c] * 2048);  // exact in a half
  }
  for (const Imf::PixelType type : {Imf::HALF, Imf::UINT}) {
    EXPECT_EQ(decode(exr_file(header_of(19, 5), rgb_channels(image, type))).pixels, image.pixels);
  }
}

TEST(Exr, TheDataWindowIsThePicture) {
  const RgbImage image = random_image(7, 9, 3);
  const Imath::Box2i display({0, 0}, {99, 99});
  for (const Imath::V2i& corner : {Imath::V2i(5, -3), {-40, 60}, {1000000, -1000000}}) {
    const Imath::Box2i data(corner, corner + Imath::V2i(6, 8));
    Imf::Header header(display, data);
    const RgbImage read = decode(float_file(image, header));
    EXPECT_EQ(read.width, 7);
    EXPECT_EQ(read.height, 9);
    EXPECT_EQ(read.pixels, image.pixels);
  }
}

TEST(Exr, LinesStoredFromTheBottomComeOutTheSame) {
  const RgbImage image = random_image(6, 40, 4);
  Imf::Header header = header_of(6, 40);
  header.lineOrder() = Imf::DECREASING_Y;
  // An output file in this order takes its rows from the last one up.
  EXPECT_EQ(decode(float_file(image, header)).pixels, image.pixels);
}

TEST(Exr, LuminanceAloneIsGrey) {
  const RgbImage image = decode(exr_file(header_of(2, 2), {{"Y", Imf::FLOAT, {1, 2, 3, 4}}}));
  EXPECT_EQ(image.at(1, 0), Vec3f::filled(2));
  EXPECT_EQ(image.at(0, 1), Vec3f::filled(3));
}

TEST(Exr, OtherChannelsBesideRedGreenBlueAreIgnored) {
  const RgbImage image = random_image(3, 2, 5);
  std::vector<ExrChannel> channels = rgb_channels(image, Imf::FLOAT);
  channels.push_back({"A", Imf::HALF, std::vector<float>(6, 0.5f)});
  channels.push_back({"diffuse.R", Imf::HALF, std::vector<float>(6, 7.0f)});
  EXPECT_EQ(decode(exr_file(header_of(3, 2), channels)).pixels, image.pixels);
}

TEST(Exr, MissingChannelsAreAnErrorThatListsTheOthers) {
  const std::vector<float> values(4, 1.0f);
  EXPECT_THAT(error_of_file(exr_file(header_of(2, 2),
                                     {{"diffuse.R", Imf::HALF, values}, {"G", Imf::HALF, values}})),
              AllOf(HasSubstr("\"G\" \"diffuse.R\""), HasSubstr("R, G and B, or Y alone")));
  EXPECT_THAT(error_of_file(exr_file(header_of(2, 2), {{"Y", Imf::HALF, values},
                                                       {"RY", Imf::HALF, values},
                                                       {"BY", Imf::HALF, values}})),
              HasSubstr("\"BY\" \"RY\" \"Y\""));
}

TEST(Exr, EveryTruncationIsAnError) {
  const RgbImage image = random_image(9, 21, 6);
  const Imf::Header header = header_of(9, 21);
  for (const Imf::Header& one :
       {header, tiled(header, 4, 16), header_of(9, 21, Imf::NO_COMPRESSION),
        header_of(9, 21, Imf::PIZ_COMPRESSION)}) {
    const std::string file = float_file(image, one);
    ASSERT_EQ(error_of_file(file), "no error");
    for (std::size_t size = 0; size < file.size(); ++size) {
      ASSERT_NE(error_of_file(file.substr(0, size)), "no error") << size << " bytes";
    }
  }
}

TEST(Exr, AWindowThatIsTooLargeIsRefusedBeforeAllocation) {
  const std::string whole = float_file(random_image(4, 4, 7), header_of(4, 4));
  const std::size_t window = value_place(whole, "dataWindow", "box2i");
  std::string file = whole;
  put(file, window + 8, 99999);
  put(file, window + 12, 99999);
  EXPECT_THAT(error_of_file(file), AllOf(HasSubstr("100000 × 100000"), HasSubstr("16384")));
  put(file, window, INT_MIN);  // wider than 32 bits can say
  put(file, window + 8, INT_MAX);
  EXPECT_THAT(error_of_file(file), HasSubstr("4294967296 × 100000"));
  put(file, window, 5);
  put(file, window + 8, 4);
  EXPECT_THAT(error_of_file(file), HasSubstr("0 × 100000"));
}

TEST(Exr, AnAttributeLargerThanTheFileIsRefusedBeforeAllocation) {
  std::string file = float_file(random_image(4, 4, 8), header_of(4, 4));
  put(file, value_place(file, "lineOrder", "lineOrder") - 4, INT_MAX);
  EXPECT_THAT(error_of_file(file), HasSubstr("truncated header"));
}

TEST(Exr, TilesThatTheFileCannotHoldAreRefusedBeforeAllocation) {
  const std::string whole = float_file(random_image(4, 4, 9), tiled(header_of(4, 4), 4, 4));
  const std::size_t window = value_place(whole, "dataWindow", "box2i");
  const std::size_t tiles = value_place(whole, "tiles", "tiledesc");
  std::string file = whole;
  put(file, window + 8, 16383);
  put(file, window + 12, 16383);
  put(file, tiles, 1);
  put(file, tiles + 4, 1);
  EXPECT_THAT(error_of_file(file), HasSubstr("268435456 tiles"));
  for (const std::int32_t side : {0, 4097, -1}) {
    put(file, tiles, side);
    EXPECT_THAT(error_of_file(file), HasSubstr("tiles with a side of")) << side;
  }
}

TEST(Exr, OtherFilesAreNamed) {
  EXPECT_THAT(error_of_file(""), HasSubstr("another format"));
  EXPECT_THAT(error_of_file("#?RADIANCE\n"), HasSubstr("another format"));
  std::string file = float_file(random_image(4, 4, 10), header_of(4, 4));
  put(file, 4, 2 | 0x800);
  EXPECT_THAT(error_of_file(file), HasSubstr("one flat part"));
}

TEST(Exr, FlippedBytesGiveAnErrorOrAPictureOfTheClaimedSize) {
  const std::string whole = float_file(random_image(12, 20, 11), header_of(12, 20));
  Random random(12);
  int refused = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::string file = whole;
    for (std::uint64_t flips = 1 + random.below(3); flips > 0; --flips) {
      // Mostly in the header, where the structure is.
      const std::size_t end = random.below(4) == 0 ? file.size() : 400;
      file[random.below(end)] = static_cast<char>(random.below(256));
    }
    try {
      const RgbImage image = decode(file);
      ASSERT_EQ(image.pixels.size(),
                static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace rimlight
