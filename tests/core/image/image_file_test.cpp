#include "core/image/image_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <limits>

#include "core/base/files.h"
#include "core/image/codec.h"
#include "core/image/tone_map.h"
#include "tests/core/image/encoded_pictures.h"
#include "tests/support/error_of.h"
#include "tests/support/real_data.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using namespace test;  // NOLINT: the makers of pictures

std::string error_of_reading(const std::filesystem::path& path) {
  return error_of([&] { read_radiance(path); });
}

TEST(ImageFile, WhatIsWrittenIsReadExactly) {
  const TemporaryFolder folder;
  RgbImage image = random_image(31, 17, 1);
  image.at(3, 4) = {1e30f, 1e-30f, 12345.678f};
  write_exr(folder / "a.exr", image);
  const RgbImage read = read_radiance(folder / "a.exr");
  EXPECT_EQ(read.width, 31);
  EXPECT_EQ(read.height, 17);
  EXPECT_EQ(read.pixels, image.pixels);
}

TEST(ImageFile, WritingReplacesTheFileAndLeavesNothingBeside) {
  const TemporaryFolder folder;
  write_exr(folder / "a.exr", random_image(5, 5, 2));
  const RgbImage second = random_image(6, 4, 3);
  write_exr(folder / "a.exr", second);
  EXPECT_EQ(read_radiance(folder / "a.exr").pixels, second.pixels);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(ImageFile, AFolderThatIsMissingIsAnErrorThatNamesTheFile) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_of([&] { write_exr(folder / "none" / "a.exr", random_image(2, 2, 4)); }),
              HasSubstr("a.exr"));
}

TEST(ImageFile, TheEndingDecidesInAnyCase) {
  const TemporaryFolder folder;
  const RgbePicture picture = random_rgbe(9, 2, 5);
  write_file_atomically(folder / "a.HDR", hdr_with_runs(picture));
  EXPECT_EQ(read_radiance(folder / "a.HDR").width, 9);
  write_file_atomically(folder / "a.exr", hdr_with_runs(picture));
  EXPECT_THAT(error_of_reading(folder / "a.exr"),
              AllOf(HasSubstr("a.exr"), HasSubstr("another format")));
  EXPECT_THAT(error_of_reading(folder / "a.png"),
              AllOf(HasSubstr("\".png\""), HasSubstr("\".hdr\" or \".exr\"")));
}

TEST(ImageFile, MissingAndEmptyFilesAreErrorsThatNameTheFile) {
  const TemporaryFolder folder;
  EXPECT_THAT(error_of_reading(folder / "none.hdr"), HasSubstr("none.hdr: found No such file"));
  EXPECT_THAT(error_of([&] { read_srgb_picture(folder / "none.png"); }),
              HasSubstr("none.png: found No such file"));
  for (const char* const name : {"empty.hdr", "empty.exr"}) {
    write_file_atomically(folder / name, "");
    EXPECT_THAT(error_of_reading(folder / name), HasSubstr(name));
  }
}

TEST(ImageFile, RadianceThatIsNotFiniteIsNamedWithItsPixel) {
  const TemporaryFolder folder;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (const float value : {kInfinity, -kInfinity, kNan}) {
    RgbImage image = random_image(8, 6, 6);
    image.at(5, 2).y = value;
    write_exr(folder / "a.exr", image);
    EXPECT_THAT(error_of_reading(folder / "a.exr"),
                AllOf(HasSubstr("a.exr: pixel (5, 2)"), HasSubstr("finite radiance")));
  }
}

TEST(ImageFile, NegativeRadianceBecomesZero) {
  const TemporaryFolder folder;
  RgbImage image = random_image(3, 3, 7);
  image.at(1, 1) = {-1, 0.5f, -1e-20f};
  write_exr(folder / "a.exr", image);
  EXPECT_EQ(read_radiance(folder / "a.exr").at(1, 1), Vec3f(0, 0.5f, 0));
}

TEST(ImageFile, PicturesBecomeLinear) {
  const TemporaryFolder folder;
  Rgb8Image picture(16, 16);
  for (std::size_t i = 0; i < 256; ++i) picture.bytes[3 * i] = static_cast<std::uint8_t>(i);
  std::vector<std::uint8_t> png;
  encode_png(picture, png);
  write_file_atomically(folder / "a.png", {reinterpret_cast<const char*>(png.data()), png.size()});
  const RgbImage image = read_srgb_picture(folder / "a.png");
  for (std::size_t i = 0; i < 256; ++i) {
    const double expected = linear_from_srgb(static_cast<double>(i) / 255);
    EXPECT_EQ(image.pixels[i], Vec3f(static_cast<float>(expected), 0, 0)) << i;
  }
  EXPECT_EQ(image.pixels[255].x, 1.0f);
}

TEST(ImageFile, PicturesAreToldApartByTheirBytes) {
  const Rgb8Image picture = smooth_image(40, 30);
  std::vector<std::uint8_t> bytes;
  JpegEncoder().encode(picture, 90, bytes);
  EXPECT_EQ(decode_srgb_picture(bytes.data(), bytes.size(), "a texture").width, 40);
  encode_png(picture, bytes);
  EXPECT_EQ(decode_srgb_picture(bytes.data(), bytes.size(), "a texture").height, 30);
  EXPECT_THAT(error_of([&] { decode_srgb_picture("GIF89a", 6, "a texture"); }),
              AllOf(HasSubstr("a texture"), HasSubstr("PNG or JPEG")));
  EXPECT_THAT(error_of([&] { decode_srgb_picture(nullptr, 0, "a texture"); }),
              HasSubstr("PNG or JPEG"));
}

TEST(ImageFile, RealProbesHaveTheirKnownSizesAndPeaks) {
  const auto found = test::real_data();
  if (!found) GTEST_SKIP() << "RIMLIGHT_DATA names no real data";
  const std::filesystem::path& data = *found;
  struct Probe {
    const char* name;
    int width, height;
    float peak;
  };
  // Peaks (largest component or more) as the data's own notes give them.
  for (const Probe& probe : {Probe{"grace_probe.hdr", 1000, 1000, 519},
                             {"uffizi_latlong.hdr", 1200, 600, 13.8f},
                             {"campus_probe.hdr", 640, 640, 196},
                             {"grace_latlong.exr", 1024, 512, 519 / 31.98f},
                             {"museum.exr", 512, 256, 0}}) {
    const RgbImage image = read_radiance(data / "probes" / probe.name);
    EXPECT_EQ(image.width, probe.width) << probe.name;
    EXPECT_EQ(image.height, probe.height) << probe.name;
    float peak = 0;
    for (const Vec3f& pixel : image.pixels) peak = std::max(peak, max_component(pixel));
    EXPECT_GE(peak, 0.98f * probe.peak) << probe.name;
    if (probe.peak > 0) {
      EXPECT_LE(peak, 2 * probe.peak) << probe.name;
    }
  }
}

}  // namespace
}  // namespace rimlight
