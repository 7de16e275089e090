// Matrices and pictures, given out by groups of pixels.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/bake/group.h"
#include "core/base/aligned_vector.h"
#include "core/base/parallel.h"
#include "core/image/codec.h"
#include "core/image/image_file.h"
#include "core/image/tone_map.h"
#include "core/import/matrix_source.h"
#include "core/import/picture_source.h"
#include "tests/core/import/npy_bytes.h"
#include "tests/support/error_of.h"
#include "tests/support/overwrite.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using ::testing::HasSubstr;

/// Different for every pixel, light and channel; exact in float.
float value_at(int x, int y, std::size_t light, int channel) {
  return static_cast<float>(x + 100 * y + 20'000 * channel) + static_cast<float>(light) * 0.0625f;
}

/// Every number that a source gives out; padded receivers must be black.
void expect_values(const TransportSource& source,
                   const std::function<float(int, int, std::size_t, int)>& expected) {
  const PixelLayout pixels = source.pixels();
  AlignedVector<float> rows(source.direction_count() * kRowLanes, -1.0f);
  std::size_t inside = 0, wrong = 0;
  for (std::size_t first = 0; first < pixels.receiver_count(); first += kGroupLanes) {
    source.read_group(first, rows);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto [x, y] = pixels.pixel(first + i % kGroupLanes);
      const bool is_inside = x < pixels.width && y < pixels.height;
      const auto channel = static_cast<int>(i / kGroupLanes % 3);
      const float value = is_inside ? expected(x, y, i / kRowLanes, channel) : 0;
      inside += is_inside ? 1 : 0;
      wrong += rows[i] == value ? 0 : 1;
    }
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(inside, static_cast<std::size_t>(pixels.width) *
                        static_cast<std::size_t>(pixels.height) * 3 * source.direction_count());
}

class Sources : public ::testing::Test {
 protected:
  std::filesystem::path matrix(const std::vector<std::size_t>& shape,
                               const std::vector<float>& values) {
    test::overwrite(folder_ / "m.npy", npy_floats(shape, values));
    return folder_ / "m.npy";
  }

  std::vector<std::filesystem::path> exr_pictures(int count, int width, int height) {
    std::vector<std::filesystem::path> paths;
    for (int light = 0; light < count; ++light) {
      RgbImage image(width, height);
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          for (int c = 0; c < 3; ++c) {
            image.at(x, y)[c] = value_at(x, y, static_cast<std::size_t>(light), c);
          }
        }
      }
      paths.push_back(folder_ / ("light_" + std::to_string(light) + ".exr"));
      write_exr(paths.back(), image);
    }
    return paths;
  }

  test::TemporaryFolder folder_;
};

TEST_F(Sources, AMatrixOfColoursIsReadPixelByPixel) {
  constexpr int kWidth = 70, kHeight = 5;
  constexpr std::size_t kLights = 3;
  std::vector<float> values;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    for (std::size_t light = 0; light < kLights; ++light) {
      for (int c = 0; c < 3; ++c) values.push_back(value_at(i % kWidth, i / kWidth, light, c));
    }
  }
  const MatrixSource source(matrix({kWidth * kHeight, kLights, 3}, values), kWidth, kHeight);
  EXPECT_EQ(source.direction_count(), kLights);
  expect_values(source, value_at);
}

TEST_F(Sources, AGreyMatrixIsTheSameInAllChannels) {
  const MatrixSource source(matrix({6, 2}, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}), 3, 2);
  expect_values(source, [](int x, int y, std::size_t light, int) {
    return static_cast<float>(2 * (x + 3 * y)) + static_cast<float>(light);
  });
}

TEST_F(Sources, AMatrixOfAnotherShapeIsAnError) {
  struct Case {
    std::vector<std::size_t> shape;
    const char* expected;
  };
  for (const Case& one : {Case{{6}, "found 6, expected"}, Case{{6, 2, 4}, "6 × 2 × 4"},
                          Case{{6, 1, 1, 3}, "6 × 1 × 1 × 3"}, Case{{4, 2}, "found 4 receivers"},
                          Case{{6, 0}, "found 0 directions"}, Case{{3, 2, 3}, "3 × 2 pixels"}}) {
    std::size_t count = 1;
    for (const std::size_t side : one.shape) count *= side;
    const std::string error =
        test::error_of([&] { MatrixSource(matrix(one.shape, std::vector<float>(count)), 3, 2); });
    EXPECT_THAT(error, HasSubstr(one.expected));
    EXPECT_THAT(error, HasSubstr("m.npy: \"shape\""));
  }
}

TEST_F(Sources, AMatrixThatIsNotFiniteSaysWhere) {
  std::vector<float> values(12, 1.0f);
  values[7] = std::numeric_limits<float>::quiet_NaN();
  const MatrixSource source(matrix({6, 2}, values), 3, 2);
  AlignedVector<float> rows(2 * kRowLanes);
  EXPECT_THAT(test::error_of([&] { source.read_group(0, rows); }), HasSubstr("[3][1]"));
}

TEST_F(Sources, PicturesAreReadPixelByPixelAndLeaveNothing) {
  const auto paths = exr_pictures(5, 66, 9);
  const test::TemporaryFolder scratch;
  set_thread_count(2);  // two at a time, where memory is scarce
  for (const std::size_t batch_bytes : {kPictureBatchBytes, std::size_t{1}}) {
    std::vector<double> told;
    const PictureSource source(
        paths, scratch.path(), [&](double share) { told.push_back(share); }, batch_bytes);
    expect_values(source, value_at);
    EXPECT_EQ(told.size(), batch_bytes == 1 ? 3u : 1u);
    EXPECT_EQ(told.back(), 1);
    EXPECT_TRUE(std::filesystem::is_empty(scratch.path()));
  }
  set_thread_count(0);
}

TEST_F(Sources, PngPicturesAreMadeLinear) {
  Rgb8Image image(9, 2);
  for (std::size_t i = 0; i < image.bytes.size(); ++i) {
    image.bytes[i] = static_cast<std::uint8_t>(i * 4);
  }
  std::vector<std::uint8_t> png;
  encode_png(image, png);
  const auto path = folder_ / "light.PNG";
  test::overwrite(path, {reinterpret_cast<const char*>(png.data()), png.size()});
  const PictureSource source({path}, folder_.path(), {});
  expect_values(source, [](int x, int y, std::size_t, int channel) {
    const int byte = 4 * (3 * (x + 9 * y) + channel);
    return static_cast<float>(linear_from_srgb(byte / 255.0));
  });
}

TEST_F(Sources, BadPicturesAreNamed) {
  auto paths = exr_pictures(3, 8, 8);
  const auto error = [&] {
    return test::error_of([&] { PictureSource(paths, folder_.path(), {}); });
  };
  EXPECT_EQ(error(), "no error");
  write_exr(paths[2], RgbImage(8, 9));
  EXPECT_THAT(error(), HasSubstr("light_2.exr: found 8 × 9 pixels, expected 8 × 8"));
  RgbImage bright(8, 8);
  bright.at(3, 1) = {0, 1e30f, 0};
  write_exr(paths[2], bright);
  EXPECT_THAT(error(), HasSubstr("light_2.exr: pixel (3, 1)"));
  test::overwrite(paths[2], "no picture");
  EXPECT_THAT(error(), HasSubstr("light_2.exr"));
  paths[2] = folder_ / "missing.png";
  EXPECT_THAT(error(), HasSubstr("missing.png"));
  paths[2] = folder_ / "light.jpg";
  EXPECT_THAT(error(), HasSubstr("\".jpg\""));
}

}  // namespace
}  // namespace rimlight
