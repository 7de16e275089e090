#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/light/environment.h"
#include "tests/core/light/light_samples.h"

namespace rimlight {
namespace {

double luminance(const Vec3f& pixel) {
  return 0.2126 * static_cast<double>(pixel.x) + 0.7152 * static_cast<double>(pixel.y) +
         0.0722 * static_cast<double>(pixel.z);
}

/// The luminance that a share of the pixels lies below.
double percentile(const Environment& environment, double share) {
  std::vector<double> values;
  for (const Vec3f& pixel : environment.image().pixels) values.push_back(luminance(pixel));
  const auto place =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

TEST(BuiltinEnvironments, AreNamedAndLit) {
  EXPECT_EQ(builtin_environment_names(),
            (std::vector<std::string>{"sunny", "studio", "cathedral"}));
  for (const std::string& name : builtin_environment_names()) {
    const Environment environment = builtin_environment(name);
    EXPECT_EQ(environment.name(), name);
    EXPECT_EQ(environment.layout(), EnvironmentLayout::lat_long);
    EXPECT_GE(environment.image().width, 1024);
    EXPECT_EQ(environment.image().width, 2 * environment.image().height);
    for (const Vec3f& pixel : environment.image().pixels) {
      ASSERT_TRUE(is_finite(pixel) && pixel.x >= 0 && pixel.y >= 0 && pixel.z >= 0);
    }
    EXPECT_GT(percentile(environment, 0.01), 0) << name << " is nowhere quite black";
    // Projected at the sizes of the product, they keep their energy.
    for (const int size : {16, 32, 64, 128}) {
      EXPECT_LE(relative_difference(integral(environment.project(size)), integral(environment)),
                1e-3)
          << name << " at " << size;
    }
  }
}

TEST(BuiltinEnvironments, TheSunIsUnclippedAndOfItsTrueSize) {
  const Environment sunny = builtin_environment("sunny");
  const RgbImage& image = sunny.image();
  const int half = image.height / 2;
  double brightest = 0, sky = 0, sky_angle = 0, disc = 0;
  Vec3d place;
  for (const Vec3f& pixel : image.pixels) brightest = std::max(brightest, luminance(pixel));
  for (int y = 0; y < half; ++y) {
    const double theta = std::numbers::pi * (y + 0.5) / image.height;
    const double angle = std::sin(theta) * 2 * std::pow(std::numbers::pi / image.height, 2);
    for (int x = 0; x < image.width; ++x) {
      const double value = luminance(image.at(x, y));
      if (value > 0.01 * brightest) {
        const double phi = 2 * std::numbers::pi * ((x + 0.5) / image.width - 0.5);
        const Vec3d direction = {std::sin(theta) * std::sin(phi), std::cos(theta),
                                 -std::sin(theta) * std::cos(phi)};
        disc += value * angle / 2;
        place += direction * (value * angle);
      } else {
        sky += value * angle;
        sky_angle += angle;
      }
    }
  }
  sky /= sky_angle;
  EXPECT_GE(brightest / sky, 1e5);
  // A radius of 0.2665° is 6.8e-5 sr; pixel middles for solid angles are good to 1e-4 here.
  const double solid_angle = 2 * std::numbers::pi * (1 - std::cos(0.2665 * std::numbers::pi / 180));
  EXPECT_NEAR(disc / (brightest * solid_angle), 1, 0.02);
  EXPECT_NEAR(std::asin(normalized(place).y) * 180 / std::numbers::pi, 40, 0.1);
  EXPECT_GT(std::abs(place.x / length(place)), 0.3) << "the sun stands to one side";
}

TEST(BuiltinEnvironments, TheWindowsAreSmallAndVeryBright) {
  const Environment cathedral = builtin_environment("cathedral");
  EXPECT_GT(percentile(cathedral, 0.995) / percentile(cathedral, 0.5), 50);
  EXPECT_LT(percentile(cathedral, 0.95) / percentile(cathedral, 0.5), 10);
}

TEST(BuiltinEnvironments, TheStudioIsDarkButForItsBoxes) {
  const Environment studio = builtin_environment("studio");
  EXPECT_GT(percentile(studio, 0.99) / percentile(studio, 0.5), 100);
}

TEST(BuiltinEnvironments, AreTheSameEachTime) {
  const Environment a = builtin_environment("cathedral"), b = builtin_environment("cathedral");
  EXPECT_EQ(a.image().pixels, b.image().pixels);
}

}  // namespace
}  // namespace rimlight
