#include "core/light/environment.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <iostream>
#include <map>
#include <numbers>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/image/image_file.h"
#include "tests/core/light/light_samples.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

/// What projection promises, relative.
constexpr double kPromise = 1e-3;
constexpr double kPi = std::numbers::pi;

/// The direction of a point of each layout, as its documentation says: (x, y) in [0, 1]² from the
/// top left corner; zero where there is none. Written apart from the product's tables.
Vec3d lat_long_point(double x, double y) {
  const double azimuth = 2 * kPi * (x - 0.5), elevation = kPi * (0.5 - y);
  return {std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
          -std::cos(elevation) * std::cos(azimuth)};
}

Vec3d angular_map_point(double x, double y) {
  const double s = 2 * x - 1, t = 1 - 2 * y, r = std::hypot(s, t);
  if (r > 1) return {};
  if (r == 0) return {0, 0, -1};
  return {std::sin(kPi * r) * s / r, std::sin(kPi * r) * t / r, -std::cos(kPi * r)};
}

/// A cross or strip as text: one letter for each square, X for +x, x for −x, blank for none.
struct CubeText {
  int columns, rows;
  const char* squares;
};
constexpr std::array<CubeText, 4> kCubeTexts = {
    {{4, 3, " Y  xzXZ y  "}, {3, 4, " Y xzX y  Z "}, {6, 1, "XxYyZz"}, {1, 6, "XxYyZz"}}};

Vec3d cube_point(const CubeText& text, double x, double y) {
  const int column = static_cast<int>(x * text.columns), row = static_cast<int>(y * text.rows);
  const char letter = text.squares[row * text.columns + column];
  if (letter == ' ') return {};
  const double sign = letter < 'a' ? 1 : -1;
  Vec3d forward, up{0, 1, 0};
  const int axis = (letter | 32) - 'x';
  forward[axis] = sign;
  if (axis == 1) up = {0, 0, sign};
  if (letter == 'Z' && text.rows == 4) up = {0, -1, 0};
  const double s = 2 * (x * text.columns - column) - 1, t = 1 - 2 * (y * text.rows - row);
  return normalized(forward + cross(forward, up) * s + up * t);
}

/// A smooth radiance without any symmetry, different in each channel.
Vec3d smooth_radiance(const Vec3d& d) {
  return {1 + 0.6 * d.x + 0.3 * d.y * d.z, 1 - 0.5 * d.y + 0.4 * d.x * d.z,
          std::exp(0.7 * d.z - 0.3 * d.x)};
}

template <typename Point>
RgbImage smooth_image(int width, int height, const Point& point) {
  RgbImage image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Vec3d direction = point((x + 0.5) / width, (y + 0.5) / height);
      if (length(direction) > 0) image.at(x, y) = Vec3f(smooth_radiance(direction));
    }
  }
  return image;
}

/// Every layout's picture of the same world, 2° a pixel or finer.
std::vector<Environment> smooth_environments() {
  std::vector<Environment> result;
  result.emplace_back("lat-long", smooth_image(360, 180, lat_long_point));
  result.emplace_back("angular map", smooth_image(301, 301, angular_map_point));
  for (const CubeText& text : kCubeTexts) {
    const auto point = [&](double x, double y) { return cube_point(text, x, y); };
    result.emplace_back("cube of " + std::to_string(text.columns) + " columns",
                        smooth_image(64 * text.columns, 64 * text.rows, point));
  }
  return result;
}

TEST(Environment, EveryLayoutShowsTheSameWorld) {
  constexpr int kSize = 16;
  for (const Environment& environment : smooth_environments()) {
    EXPECT_NE(environment.layout(), EnvironmentLayout::automatic);
    const CubeLight light = environment.project(kSize);
    double worst = 0;
    for (std::size_t texel = 0; texel < light.count(); ++texel) {
      const Vec3d truth = smooth_radiance(cube::texel_direction(texel, kSize));
      worst = std::max(worst, length(Vec3d(light.at(texel)) - truth));
    }
    // Constant pixels of 1.2° at most and slopes of about 1: half a pixel, 0.01; and as much for
    // the curvature inside a texel of 6°.
    EXPECT_LE(worst, 0.02) << environment.name();
  }
}

TEST(Environment, LayoutsFollowFromTheSides) {
  const auto layout = [](int width, int height) {
    return Environment("sides", RgbImage(width, height)).layout();
  };
  EXPECT_EQ(layout(64, 32), EnvironmentLayout::lat_long);
  EXPECT_EQ(layout(63, 31), EnvironmentLayout::lat_long);
  EXPECT_EQ(layout(50, 50), EnvironmentLayout::angular_map);
  EXPECT_EQ(layout(40, 30), EnvironmentLayout::cube);
  EXPECT_EQ(layout(30, 40), EnvironmentLayout::cube);
  EXPECT_EQ(layout(60, 10), EnvironmentLayout::cube);
  EXPECT_EQ(layout(10, 60), EnvironmentLayout::cube);
  EXPECT_EQ(layout(1, 1), EnvironmentLayout::angular_map);
}

/// ∫ L dω of a lat-long image from the closed form of its pixels' solid angles.
Vec3d lat_long_integral(const RgbImage& image) {
  Vec3d sum;
  for (int y = 0; y < image.height; ++y) {
    const double ring = 2 * kPi / image.width *
                        (std::cos(kPi * y / image.height) - std::cos(kPi * (y + 1) / image.height));
    for (int x = 0; x < image.width; ++x) sum += Vec3d(image.at(x, y)) * ring;
  }
  return sum;
}

TEST(Environment, TheIntegralOfAnImageIsThatOfItsPixels) {
  Random random(71);
  RgbImage image(37, 19);
  for (Vec3f& pixel : image.pixels) pixel = {random.uniform_float(), random.uniform_float(), 1};
  const Vec3d truth = lat_long_integral(image);
  EXPECT_LE(relative_difference(integral(Environment("noise", image)), truth), 1e-12);
  for (const Environment& environment : smooth_environments()) {
    // ∫ of the three channels: only the constant parts, and (4π sinh a)/a with a = |(−0.3, 0, 0.7)|
    const double a = std::hypot(0.3, 0.7);
    const Vec3d closed = {4 * kPi, 4 * kPi, 4 * kPi * std::sinh(a) / a};
    EXPECT_LE(relative_difference(integral(environment), closed), 2e-3) << environment.name();
  }
}

struct Sides {
  int width, height;
};
constexpr std::array<Sides, 5> kLatLongSides = {
    {{64, 32}, {100, 51}, {256, 128}, {512, 256}, {1200, 600}}};
constexpr std::array<int, 4> kSizes = {16, 32, 64, 128};

TEST(Environment, ProjectionKeepsTheEnergyOfNoise) {
  Random random(72);
  std::map<int, double> worst;
  for (const auto& [width, height] : kLatLongSides) {
    RgbImage image(width, height);
    for (Vec3f& pixel : image.pixels) {
      // Dense noise, and sparse noise that stays just below the cap of 16 times the mean.
      pixel = {random.uniform_float(), random.below(15) == 0 ? 1.0f : 0.0f,
               random.below(4) == 0 ? 1.0f : 0.0f};
    }
    const Environment environment("noise", image);
    for (const int size : kSizes) {
      const double error =
          relative_difference(integral(environment.project(size)), lat_long_integral(image));
      worst[size] = std::max(worst[size], error);
      EXPECT_LE(error, kPromise) << width << "×" << height << " to " << size;
    }
  }
  for (const auto& [size, error] : worst) {
    std::cout << "size " << size << ": worst energy error of noise " << error << "\n";
  }
}

TEST(Environment, ProjectionKeepsASunOfOnePixelAndItsPlace) {
  constexpr std::array<std::pair<double, double>, 4> kPlaces = {
      {{0.7, 0.3}, {0.5, 0.5}, {0.0, 0.01}, {0.999, 0.75}}};
  std::size_t place = 0;
  for (const auto& [width, height] : kLatLongSides) {
    for (const int size : kSizes) {
      const auto& [u, v] = kPlaces[place++ % kPlaces.size()];
      RgbImage image(width, height);
      for (Vec3f& pixel : image.pixels) pixel = Vec3f::filled(0.5f);
      const int x = static_cast<int>(u * width), y = static_cast<int>(v * height);
      image.at(x, y) = {1e6f, 8e5f, 6e5f};
      const CubeLight light = Environment("sun", image).project(size);
      ASSERT_LE(relative_difference(integral(light), lat_long_integral(image)), kPromise)
          << width << "×" << height << " to " << size;
      const Vec3d sun = lat_long_point((x + 0.5) / width, (y + 0.5) / height);
      // Both the pixel and the texel smear the place; a whole one of each is generous.
      ASSERT_LE(angle_between(first_moment(light, 0), sun), kPi / height + 2.0 / size);
    }
    ++place;  // so that every size meets other places with other sides
  }
}

TEST(Environment, AUniformImageStaysUniformInEveryLayoutAndSize) {
  const std::array<Sides, 8> sides = {
      {{1, 1}, {2, 1}, {64, 32}, {101, 50}, {90, 90}, {64, 48}, {9, 12}, {60, 10}}};
  for (const auto& [width, height] : sides) {
    RgbImage image(width, height);
    for (Vec3f& pixel : image.pixels) pixel = {2, 3, 0.25f};
    const Environment environment("grey", image);
    for (const int size : {2, 16, width == 101 ? 128 : 32}) {
      const CubeLight light = environment.project(size);
      for (std::size_t texel = 0; texel < light.count(); ++texel) {
        const Vec3f radiance = light.at(texel);
        ASSERT_NEAR(radiance.x, 2, 2 * kPromise) << width << "×" << height << " to " << size;
        ASSERT_NEAR(radiance.y, 3, 3 * kPromise);
        ASSERT_NEAR(radiance.z, 0.25, 0.25 * kPromise);
      }
    }
  }
}

TEST(Environment, WhatLiesOutsideTheAngularMapsCircleIsIgnored) {
  RgbImage image = smooth_image(100, 100, angular_map_point);
  const CubeLight clean = Environment("clean", image).project(16);
  for (const int x : {0, 1, 99}) {
    for (const int y : {0, 1, 99}) {
      if (length(angular_map_point((x + 0.5) / 100, (y + 0.5) / 100)) == 0) {
        image.at(x, y) = Vec3f::filled(1e6f);  // a caption
      }
    }
  }
  const CubeLight captioned = Environment("captioned", image).project(16);
  EXPECT_EQ(std::memcmp(clean.values.data(), captioned.values.data(),
                        clean.values.size() * sizeof(float)),
            0);
}

TEST(Environment, ProjectionGivesTheSameBitsAtAnyThreadCount) {
  Random random(73);
  RgbImage image(300, 150);
  for (Vec3f& pixel : image.pixels) {
    pixel = Vec3f::filled(std::exp(6 * random.uniform_float()));
  }
  const Environment environment("noise", image);
  set_thread_count(1);
  const CubeLight alone = environment.project(64);
  for (const int threads : {2, 3, 7}) {
    set_thread_count(threads);
    const CubeLight together = environment.project(64);
    EXPECT_EQ(std::memcmp(alone.values.data(), together.values.data(),
                          alone.values.size() * sizeof(float)),
              0)
        << threads;
  }
  set_thread_count(0);
}

TEST(Environment, ProjectsEightThousandPixelsAcross) {
  const Environment environment("large", smooth_image(8192, 4096, lat_long_point));
  const CubeLight light = environment.project(64);
  for (std::size_t texel = 0; texel < light.count(); ++texel) {
    const Vec3d truth = smooth_radiance(cube::texel_direction(texel, 64));
    ASSERT_LE(length(Vec3d(light.at(texel)) - truth), 2e-3);
  }
}

TEST(Environment, RefusesWhatIsNoEnvironment) {
  using test::error_of;
  const auto make = [](RgbImage image, EnvironmentLayout layout) {
    return error_of([&] { Environment("studio.hdr", std::move(image), layout); });
  };
  EXPECT_EQ(make(RgbImage(), EnvironmentLayout::automatic),
            "studio.hdr: found 0×0 pixels, expected an image of at least one pixel");
  EXPECT_EQ(make(RgbImage(4, 2), EnvironmentLayout::angular_map),
            "studio.hdr: found 4×2 pixels, expected a square image for an angular map");
  EXPECT_EQ(make(RgbImage(4, 2), EnvironmentLayout::cube),
            "studio.hdr: found 4×2 pixels, expected sides as 4:3, 3:4, 6:1 or 1:6 for a cube");
  for (const float bad : {-1.0f, std::nanf(""), INFINITY}) {
    RgbImage image(4, 2);
    image.at(3, 1).y = bad;
    EXPECT_NE(make(image, EnvironmentLayout::lat_long).find("studio.hdr: pixel (3, 1)"),
              std::string::npos);
  }
  EXPECT_EQ(error_of([] { builtin_environment("sunny\n"); }),
            "environment: found \"sunny\\x0a\", expected \"sunny\", \"studio\", \"cathedral\"");
}

TEST(Environment, LoadsAFileByItsStem) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "evening.exr";
  const RgbImage image = smooth_image(32, 16, lat_long_point);
  write_exr(path, image);
  const Environment environment = load_environment(path);
  EXPECT_EQ(environment.name(), "evening");
  EXPECT_EQ(environment.layout(), EnvironmentLayout::lat_long);
  ASSERT_EQ(environment.image().pixels.size(), image.pixels.size());
  EXPECT_EQ(environment.image().pixels, image.pixels);
  EXPECT_THROW(load_environment(folder.path() / "none.hdr"), Error);
}

}  // namespace
}  // namespace rimlight
