#include "core/image/codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>
#include <turbojpeg.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/math/random.h"
#include "tests/core/image/encoded_pictures.h"
#include "tests/support/allocation_count.h"
#include "tests/support/error_of.h"

namespace rimlight {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using namespace test;  // NOLINT: the makers of pictures

using Bytes = std::vector<std::uint8_t>;

Bytes png_of(const Rgb8Image& image) {
  Bytes png;
  encode_png(image, png);
  return png;
}

Bytes jpeg_of(const Rgb8Image& image, int quality) {
  Bytes jpeg;
  JpegEncoder().encode(image, quality, jpeg);
  return jpeg;
}

std::string error_of_png(const Bytes& file, std::size_t size) {
  return error_of([&] { decode_png(file.data(), size, "a.png"); });
}
std::string error_of_jpeg(const Bytes& file, std::size_t size) {
  return error_of([&] { decode_jpeg(file.data(), size, "a.jpg"); });
}

double psnr(const Rgb8Image& a, const Rgb8Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.bytes.size(); ++i) {
    const double difference = a.bytes[i] - b.bytes[i];
    sum += difference * difference;
  }
  return 10 * std::log10(255 * 255 * static_cast<double>(a.bytes.size()) / sum);
}

/// A file of another pixel format, by libpng's own writer.
Bytes png_in_format(png_uint_32 format, int width, int height, const void* pixels) {
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = format;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  Bytes file(size);
  EXPECT_NE(png_image_write_to_memory(&image, file.data(), &size, 0, pixels, 0, nullptr), 0);
  file.resize(size);
  return file;
}

TEST(Png, IsLosslessAtAnySize) {
  for (const auto& [width, height] :
       {std::pair(1, 1), {1, 7}, {7, 1}, {33, 17}, {129, 65}, {3, 300}}) {
    const Rgb8Image image = random_bytes_image(width, height, 1);
    const Bytes png = png_of(image);
    const Rgb8Image read = decode_png(png.data(), png.size(), "a.png");
    EXPECT_EQ(read.width, width);
    EXPECT_EQ(read.height, height);
    EXPECT_EQ(read.bytes, image.bytes);
  }
}

TEST(Png, SaysThatItIsSrgb) {
  const Bytes png = png_of(smooth_image(8, 8));
  const std::string text(png.begin(), png.end());
  EXPECT_THAT(text, AllOf(HasSubstr("sRGB"), HasSubstr("IEND")));
}

TEST(Png, EveryTruncationIsAnError) {
  const Bytes png = png_of(smooth_image(37, 21));
  ASSERT_EQ(error_of_png(png, png.size()), "no error");
  for (std::size_t size = 0; size < png.size(); ++size) {
    ASSERT_THAT(error_of_png(png, size), HasSubstr("a.png: found")) << size << " bytes";
  }
}

TEST(Png, AFlippedBitIsAnErrorOrChangesNothing) {
  const Rgb8Image image = smooth_image(37, 21);
  const Bytes whole = png_of(image);
  int refused = 0;
  for (std::size_t bit = 0; bit < 8 * whole.size(); bit += 3) {
    Bytes png = whole;
    png[bit / 8] = static_cast<std::uint8_t>(png[bit / 8] ^ 1u << bit % 8);
    try {
      ASSERT_EQ(decode_png(png.data(), png.size(), "a.png").bytes, image.bytes) << "bit " << bit;
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, static_cast<int>(whole.size()));  // most of the 8/3 trials a byte
}

TEST(Png, AlphaIsDroppedAndDoesNotDarken) {
  const std::uint8_t pixels[2][4] = {{200, 100, 50, 0}, {10, 20, 30, 128}};
  const Bytes png = png_in_format(PNG_FORMAT_RGBA, 2, 1, pixels);
  const Rgb8Image image = decode_png(png.data(), png.size(), "a.png");
  EXPECT_THAT(image.bytes, ::testing::ElementsAre(200, 100, 50, 10, 20, 30));
}

TEST(Png, GreyBecomesThreeChannels) {
  const std::uint8_t pixels[3] = {0, 77, 255};
  const Bytes png = png_in_format(PNG_FORMAT_GRAY, 3, 1, pixels);
  const Rgb8Image image = decode_png(png.data(), png.size(), "a.png");
  EXPECT_THAT(image.bytes, ::testing::ElementsAre(0, 0, 0, 77, 77, 77, 255, 255, 255));
}

TEST(Png, ASideThatIsTooLargeIsRefused) {
  const Bytes pixels(3 * 16385);
  const Bytes png = png_in_format(PNG_FORMAT_RGB, 16385, 1, pixels.data());
  EXPECT_THAT(error_of_png(png, png.size()), AllOf(HasSubstr("a.png"), HasSubstr("16385 × 1")));
}

TEST(Jpeg, KeepsTheSizeAndTheLookAtAnySize) {
  for (const auto& [width, height] : {std::pair(1, 1), {1, 7}, {17, 1}, {33, 17}, {129, 65}}) {
    const Rgb8Image image = smooth_image(width, height);
    const Bytes jpeg = jpeg_of(image, 90);
    const Rgb8Image read = decode_jpeg(jpeg.data(), jpeg.size(), "a.jpg");
    ASSERT_EQ(read.width, width);
    ASSERT_EQ(read.height, height);
    EXPECT_GT(psnr(read, image), 28) << width << " × " << height;
  }
}

/// The picture in one piece, by libjpeg-turbo alone.
Bytes jpeg_in_one_piece(const Rgb8Image& image, int quality) {
  const tjhandle compressor = tjInitCompress();
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  EXPECT_EQ(tjCompress2(compressor, image.bytes.data(), image.width, 0, image.height, TJPF_RGB,
                        &bytes, &size, TJSAMP_420, quality, 0),
            0);
  const Bytes file(bytes, bytes + size);
  tjFree(bytes);
  tjDestroy(compressor);
  return file;
}

TEST(Jpeg, StripesDecodeToThePixelsOfAFileInOnePiece) {
  // About the heights where another stripe begins, and one that needs more than eight.
  for (const auto& [width, height] : {std::pair(40, 64),
                                      {40, 65},
                                      {17, 81},
                                      {640, 511},
                                      {640, 512},
                                      {1921, 1081},
                                      {33, 2047},
                                      {16384, 1100}}) {
    const Rgb8Image image = smooth_image(width, height);
    const Bytes jpeg = jpeg_of(image, 80), whole = jpeg_in_one_piece(image, 80);
    const Rgb8Image read = decode_jpeg(jpeg.data(), jpeg.size(), "a.jpg");
    EXPECT_EQ(read.height, height);
    EXPECT_EQ(read.bytes, decode_jpeg(whole.data(), whole.size(), "b.jpg").bytes)
        << width << " × " << height;
    const auto more = static_cast<double>(jpeg.size()) - static_cast<double>(whole.size());
    EXPECT_LE(more, 0.03 * static_cast<double>(whole.size()) + 200) << width << " × " << height;
    EXPECT_EQ(jpeg == whole, height <= 64);
  }
}

TEST(Jpeg, MoreQualityIsCloserAndLarger) {
  const Rgb8Image image = smooth_image(256, 192);
  double last_psnr = 0;
  std::size_t last_size = 0;
  for (const int quality : {5, 20, 40, 60, 80, 95}) {
    const Bytes jpeg = jpeg_of(image, quality);
    const double now = psnr(decode_jpeg(jpeg.data(), jpeg.size(), "a.jpg"), image);
    EXPECT_GT(now, last_psnr) << quality;
    EXPECT_GT(jpeg.size(), last_size) << quality;
    last_psnr = now;
    last_size = jpeg.size();
  }
}

TEST(Jpeg, TheSameEncoderGivesTheSameBytesAfterOtherFrames) {
  JpegEncoder encoder;
  const Rgb8Image image = smooth_image(100, 60);
  Bytes first, other, second;
  encoder.encode(image, 80, first);
  encoder.encode(random_bytes_image(301, 77, 2), 95, other);
  encoder.encode(image, 80, second);
  EXPECT_EQ(first, second);
}

TEST(Jpeg, AllocatesNothingAfterTheFirstFrame) {
  if (!kCountsAllocations) GTEST_SKIP() << "ThreadSanitizer keeps operator new to itself";
  JpegEncoder encoder;
  const Rgb8Image image = smooth_image(320, 200);
  Bytes jpeg;
  const std::size_t before = allocation_count();
  encoder.encode(image, 80, jpeg);
  const std::size_t warm = allocation_count();
  EXPECT_GT(warm, before);  // the counter counts
  for (int i = 0; i < 10; ++i) encoder.encode(image, 80, jpeg);
  EXPECT_EQ(allocation_count(), warm);
}

TEST(Jpeg, EveryTruncationIsAnError) {
  const Bytes jpeg = jpeg_of(smooth_image(70, 50), 80);
  ASSERT_EQ(error_of_jpeg(jpeg, jpeg.size()), "no error");
  for (std::size_t size = 0; size < jpeg.size(); ++size) {
    ASSERT_THAT(error_of_jpeg(jpeg, size), HasSubstr("a.jpg: found")) << size << " bytes";
  }
}

TEST(Jpeg, FlippedBytesGiveAnErrorOrAPicture) {
  const Bytes whole = jpeg_of(smooth_image(70, 50), 80);
  Random random(3);
  int refused = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    Bytes jpeg = whole;
    for (std::uint64_t flips = 1 + random.below(3); flips > 0; --flips) {
      jpeg[random.below(jpeg.size())] = static_cast<std::uint8_t>(random.below(256));
    }
    try {
      const Rgb8Image image = decode_jpeg(jpeg.data(), jpeg.size(), "a.jpg");
      ASSERT_EQ(image.bytes.size(),
                static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 3);
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

TEST(Jpeg, AClaimThatIsTooLargeIsRefused) {
  Bytes jpeg = jpeg_of(smooth_image(8, 8), 80);
  const std::uint8_t frame_marker[] = {0xff, 0xc0};
  const auto frame =
      std::search(jpeg.begin(), jpeg.end(), std::begin(frame_marker), std::end(frame_marker));
  ASSERT_NE(frame, jpeg.end());
  std::fill(frame + 5, frame + 9, std::uint8_t{0xf0});  // height and width, behind the precision
  EXPECT_THAT(error_of_jpeg(jpeg, jpeg.size()), HasSubstr("61680 × 61680"));
}

TEST(Codec, NoBytesAreAnError) {
  EXPECT_NE(error_of([] { decode_png(nullptr, 0, "a.png"); }), "no error");
  EXPECT_NE(error_of([] { decode_jpeg(nullptr, 0, "a.jpg"); }), "no error");
}

TEST(Codec, AnImageWhoseBytesDoNotFitItsSizeIsABug) {
  Rgb8Image image(4, 4);
  image.height = 5;
  Bytes bytes;
  EXPECT_THROW(encode_png(image, bytes), CheckFailure);
  EXPECT_THROW(JpegEncoder().encode(image, 80, bytes), CheckFailure);
  EXPECT_THROW(JpegEncoder().encode(Rgb8Image(4, 4), 101, bytes), CheckFailure);
  EXPECT_THROW(encode_png(Rgb8Image(), bytes), CheckFailure);
}

}  // namespace
}  // namespace rimlight
