// Light at the extremes of radiance, from environment to texels, turned texels and coefficients.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/basis/cube_haar.h"
#include "core/light/environment.h"
#include "core/light/light_rotation.h"
#include "core/light/sun_and_sky.h"
#include "core/math/random.h"
#include "core/report/stability/cases.h"

namespace rimlight::stability {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kWidth = 256, kHeight = 128, kSize = 32;

/// ∫ L dω over a lat-long image's pixels, by rows of their exact solid angles.
double lat_long_integral(const RgbImage& image) {
  double sum = 0;
  for (int y = 0; y < image.height; ++y) {
    const double solid_angle =
        2 * kPi / image.width *
        (std::cos(kPi * y / image.height) - std::cos(kPi * (y + 1) / image.height));
    for (int x = 0; x < image.width; ++x) sum += double{image.at(x, y).x} * solid_angle;
  }
  return sum;
}

RgbImage grey_image(const std::function<double(int x, int y)>& radiance) {
  RgbImage image(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      image.at(x, y) = Vec3f::filled(static_cast<float>(radiance(x, y)));
    }
  }
  return image;
}

/// Relative error of the integral on a cube map, and after turns of it.
double integral_error(const RgbImage& image, double expected, const StabilityTrial& trial) {
  LightRotator rotator(Environment("measured", image).project(kSize));
  double worst = std::abs(integral(rotator.source()).x / expected - 1);
  Random random(2);
  CubeLight turned;
  for (int i = 0; i < (trial.fast ? 3 : 20); ++i) {
    rotator.rotate(random_rotation(random), turned);
    worst = std::max(worst, std::abs(integral(turned).x / expected - 1));
  }
  return worst;
}

StabilityMeasure radiance_range(const StabilityTrial& trial) {
  Random random(1);
  RgbImage image = grey_image([&](int, int) { return std::pow(10, random.uniform(-8, 8)); });
  const double expected = lat_long_integral(image);
  for (Vec3f& pixel : image.pixels) pixel *= trial.either(1.0f, 1.01f);
  return {integral_error(image, expected, trial)};
}

StabilityMeasure sun_of_one_pixel(const StabilityTrial& trial) {
  RgbImage image = grey_image([](int, int) { return 1e-8; });
  image.at(77, 31) = Vec3f::filled(1e8f);
  const double expected = lat_long_integral(image);
  image.at(77, 31) *= trial.either(1.0f, 0.99f);
  return {integral_error(image, expected, trial)};
}

/// A hemisphere of 1e8 beside one of 1e-8, turned: texels well inside the dark one.
StabilityMeasure dark_beside_bright(const StabilityTrial& trial) {
  CubeLight source(kSize);
  const auto is_bright = [](const Vec3d& direction) { return direction.y > 0.1; };
  for (std::size_t t = 0; t < source.count(); ++t) {
    const float radiance = is_bright(cube::texel_direction(t, kSize)) ? 1e8f : 1e-8f;
    for (int c = 0; c < 3; ++c) source.channel(c)[t] = radiance;
  }
  LightRotator rotator(source);
  CubeLight turned;
  Random random(3);
  double worst = 0;
  for (int i = 0; i < (trial.fast ? 3 : 20); ++i) {
    const Quaternion turn = random_rotation(random);
    rotator.rotate(turn, turned);
    for (std::size_t t = 0; t < turned.count(); ++t) {
      const Vec3d from = rotated(conjugate(turn), cube::texel_direction(t, kSize));
      if (from.y > trial.either(-0.1, 0.11)) continue;  // three texels from the border
      worst = std::max(worst, std::abs(double{turned.values[t]} / 1e-8 - 1));
    }
  }
  return {worst};
}

StabilityMeasure single_lit_texel(const StabilityTrial& trial) {
  constexpr int kSmall = 16;
  Random random(4);
  double worst = 0;
  for (int i = 0; i < (trial.fast ? 20 : 300); ++i) {
    CubeLight source(kSmall);
    const std::size_t lit = random.below(source.count());
    for (int c = 0; c < 3; ++c) source.channel(c)[lit] = 1e6f;
    const double energy = 1e6 * cube::texel_solid_angle(lit, kSmall);
    CubeLight turned;
    LightRotator(std::move(source)).rotate(random_rotation(random), turned);
    const double kept = integral(turned).x * trial.either(1.0, 1.002);
    worst = std::max(worst, std::abs(kept / energy - 1));
  }
  return {worst};
}

StabilityMeasure all_black(const StabilityTrial& trial) {
  RgbImage image = grey_image([](int, int) { return 0; });
  if (trial.broken) image.at(0, 0) = {1, 0, 0};
  LightRotator rotator(Environment("black", std::move(image)).project(kSize));
  CubeLight turned;
  rotator.rotate(axis_angle({1, 2, 3}, 1), turned);
  const SunAndSky split = split_sun(turned);
  std::vector<float> coefficients(turned.count());
  const CubeHaar haar(kSize);
  haar.forward(turned.channel(0), coefficients);
  double worst = split.sun ? 1 : 0;
  for (const float value : split.sky.values) worst = std::max(worst, std::abs(double{value}));
  for (const float value : coefficients) worst = std::max(worst, std::abs(double{value}));
  return {worst};
}

CubeLight uniform_light(const StabilityTrial& trial) {
  RgbImage image = grey_image([](int, int) { return 3; });
  if (trial.broken) image.at(40, 40) = Vec3f::filled(4);
  return Environment("uniform", std::move(image)).project(kSize);
}

StabilityMeasure uniform_turned(const StabilityTrial& trial) {
  LightRotator rotator(uniform_light(trial));
  CubeLight turned;
  Random random(5);
  double worst = 0;
  for (int i = 0; i < (trial.fast ? 3 : 20); ++i) {
    rotator.rotate(random_rotation(random), turned);
    for (const float value : turned.values) worst = std::max(worst, std::abs(value / 3.0 - 1));
  }
  return {worst};
}

StabilityMeasure uniform_coefficients(const StabilityTrial& trial) {
  CubeLight light = uniform_light(trial);
  const CubeHaar haar(kSize);
  std::vector<float> coefficients(light.count());
  haar.forward(light.channel(0), coefficients);
  double others = 0;
  for (std::size_t j = 0; j < coefficients.size(); ++j) {
    const bool scaling = j < haar.band_begin(1) && j % 4 == 0;
    if (!scaling) others = std::max(others, std::abs(double{coefficients[j]}));
  }
  return {others / coefficients[0]};
}

/// Sixteen decades through the Haar transform and back: relative to the largest value, for what
/// is small beside a large one is rounded with it.
StabilityMeasure haar_range(const StabilityTrial& trial) {
  CubeLight light(kSize);
  Random random(6);
  for (float& value : light.channel(0)) {
    value = static_cast<float>(std::pow(10, random.uniform(-8, 8)));
  }
  const std::vector<float> truth(light.channel(0).begin(), light.channel(0).end());
  const CubeHaar haar(kSize);
  std::vector<float> coefficients(truth.size()), texels(truth.size());
  haar.forward(light.channel(0), coefficients);
  coefficients[0] *= trial.either(1.0f, 1.001f);
  haar.inverse(coefficients, texels);
  double worst = 0;
  for (std::size_t t = 0; t < texels.size(); ++t) {
    worst = std::max(worst, std::abs(double{texels[t]} - double{truth[t]}));
  }
  return {worst / *std::ranges::max_element(truth)};
}

/// The brightest environment that is taken, over a whole cube map of 512 texels a side; and how
/// many brighter ones are taken too.
StabilityMeasure brightest(const StabilityTrial& trial) {
  const int size = trial.fast ? 128 : 512;
  LightRotator rotator(
      Environment("bright", grey_image([](int, int) { return 1e32; })).project(size));
  CubeLight turned;
  rotator.rotate(axis_angle({1, 2, 3}, 1), turned);
  std::vector<float> coefficients(turned.count());
  CubeHaar(size).forward(turned.channel(0), coefficients);
  double faults = 0;
  for (const float value : coefficients) faults += std::isfinite(value) ? 0 : 1;
  for (const double radiance : {2e32, 1e37, 3e38, trial.either(1e38, 1e32)}) {
    try {
      static_cast<void>(Environment("brighter", grey_image([&](int, int) { return radiance; })));
      ++faults;
    } catch (const Error&) {
    }
  }
  return {faults};
}

}  // namespace

std::vector<StabilityCase> light_cases() {
  using enum BoundKind;
  const std::string part = "light";
  const std::string promise = "what projection and rotation promise: ∫L dω to 0.1 %";
  return {
      {"radiance-1e-8-to-1e8", part, "relative error of ∫L dω, projected and turned", at_most, 1e-3,
       promise, radiance_range},
      {"sun-of-one-pixel", part, "relative error of ∫L dω: 1e8 in one pixel over 1e-8", at_most,
       1e-3, promise, sun_of_one_pixel},
      {"dark-beside-bright", part,
       "relative error of texels of 1e-8 beside a hemisphere of 1e8, turned", at_most, 1e-3,
       "uniform stays uniform to 0.1 %, whatever shines elsewhere", dark_beside_bright},
      {"single-lit-texel", part, "relative error of a lit texel's energy, turned", at_most, 1e-3,
       promise, single_lit_texel},
      {"all-black", part, "largest |value| of a black light's texels and coefficients", at_most, 0,
       "sums of zeros are zero", all_black},
      {"uniform-turned", part, "relative error of a uniform light's texels, turned", at_most, 1e-3,
       "what rotation promises: uniform to 0.1 %", uniform_turned},
      {"uniform-coefficients", part,
       "largest coefficient beside the scaling ones, relative to these", at_most, 0x1p-19,
       "5 levels of sums of floats, each rounded to 2⁻²⁴; the projection's texels to 2⁻²²",
       uniform_coefficients},
      {"brightest-radiance", part,
       "coefficients of 1e32 everywhere that are no numbers, and brighter lights that were taken",
       at_most, 0, "sums over a face of 512² texels stay within floats: 1e32 · 512 of 3.4e38",
       brightest},
      {"haar-range", part,
       "error of 16 decades through the Haar transform and back, over the largest value", at_most,
       40 * 0x1p-24, "2 · 4 log₂ N = 40 roundings to 2⁻²⁴", haar_range},
  };
}

}  // namespace rimlight::stability
