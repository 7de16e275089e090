#include "core/light/sun_and_sky.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/light/environment.h"
#include "core/light/soft_disc.h"
#include "core/math/random.h"
#include "core/math/sampling.h"
#include "tests/support/real_data.h"

namespace rimlight {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr int kSize = 128;

/// An uneven sky, 0.5 to 1.5.
CubeLight uneven_sky(int size) {
  CubeLight light(size);
  for (std::size_t i = 0; i < light.count(); ++i) {
    const Vec3d way = cube::texel_direction(i, size);
    for (int c = 0; c < 3; ++c) {
      light.channel(c)[i] = static_cast<float>(1 + 0.5 * std::sin(3 * way[c] + way[(c + 1) % 3]));
    }
  }
  return light;
}

CubeLight with_disc(CubeLight light, const Vec3d& direction, double radius, const Vec3d& radiance) {
  add_disc({normalized(direction), radius, 0}, radiance, light);
  return light;
}

Vec3d irradiance(const CubeLight& light, const Vec3d& normal) {
  Vec3d sum;
  for (std::size_t i = 0; i < light.count(); ++i) {
    const double cosine = dot(cube::texel_direction(i, light.size), normal);
    sum += Vec3d(light.at(i)) * (std::max(cosine, 0.0) * cube::texel_solid_angle(i, light.size));
  }
  return sum;
}

TEST(SplitSun, FindsADiscWhereItIsAsBrightAndAsWideAsItIs) {
  Random random(4);
  for (int trial = 0; trial < 12; ++trial) {
    const Vec3d way = uniform_sphere(random_sample(random));
    const double radius = random.uniform(1, 2) * kDegree;
    const Vec3d radiance(3000, 2500, 1500);
    const SunAndSky split = split_sun(with_disc(uneven_sky(kSize), way, radius, radiance));
    ASSERT_TRUE(split.sun);
    EXPECT_LT(length(split.sun->direction - way), 0.05 * kDegree);
    EXPECT_NEAR(split.sun->angular_radius, radius, 0.15 * kDegree);
    const double solid_angle = 2 * std::numbers::pi * (1 - std::cos(radius));
    // Texels that were below the ring's mean keep some of the disc: no more than the sky's wave.
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(split.sun->irradiance[c], radiance[c] * solid_angle,
                  1e-3 * radiance[c] * solid_angle);
    }
  }
}

TEST(SplitSun, SkyAndSunAreTheWhole) {
  Random random(5);
  for (int trial = 0; trial < 6; ++trial) {
    const Vec3d way = uniform_sphere(random_sample(random));
    const CubeLight whole = with_disc(uneven_sky(kSize), way, 1 * kDegree, {3000, 4000, 6000});
    const auto [sky, sun] = split_sun(whole);
    ASSERT_TRUE(sun);
    const Vec3d all = integral(whole), rest = integral(sky) + sun->irradiance;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(rest[c], all[c], 1e-12 * all[c]);
    for (int i = 0; i < 20; ++i) {
      const Vec3d normal = uniform_sphere(random_sample(random));
      const double cosine = dot(normal, sun->direction);
      if (std::abs(cosine) < 0.1) continue;  // part of the disc below the horizon
      const Vec3d expected = irradiance(whole, normal);
      const Vec3d found = irradiance(sky, normal) + sun->irradiance * std::max(cosine, 0.0);
      // The middle of a disc's light is its cosine times as far out: 1 - r²/4.
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 2e-4 * expected[c]);
    }
    for (std::size_t i = 0; i < sky.values.size(); ++i) {
      ASSERT_GE(sky.values[i], 0);
      ASSERT_LE(sky.values[i], whole.values[i]);
    }
  }
}

TEST(SplitSun, TheSpotLooksLikeItsSurroundings) {
  const auto [sky, sun] =
      split_sun(with_disc(uneven_sky(kSize), {1, 2, 3}, kDegree, {2000, 2000, 2000}));
  ASSERT_TRUE(sun);
  EXPECT_LT(*std::ranges::max_element(sky.values), 1.6f);
}

TEST(SplitSun, OneLitTexelIsASunUnderABlackSky) {
  for (const int size : {2, 16, kSize}) {
    CubeLight light(size);
    const std::size_t lit = light.count() * 2 / 3 + 1;
    for (int c = 0; c < 3; ++c) light.channel(c)[lit] = static_cast<float>(c + 2);
    const auto [sky, sun] = split_sun(light);
    ASSERT_TRUE(sun);
    for (const float value : sky.values) ASSERT_EQ(value, 0);
    EXPECT_LT(length(sun->direction - cube::texel_direction(lit, size)), 1e-12);
    EXPECT_EQ(sun->irradiance, Vec3d(2, 3, 4) * cube::texel_solid_angle(lit, size));
    EXPECT_EQ(sun->angular_radius, 0);
  }
}

void expect_none(const CubeLight& light, const char* what) {
  const SunAndSky split = split_sun(light);
  EXPECT_FALSE(split.sun) << what;
  EXPECT_EQ(split.sky.values, light.values) << what;
}

TEST(SplitSun, LightWithoutASunStaysAsItIs) {
  CubeLight uniform(kSize);
  std::ranges::fill(uniform.values, 2.0f);
  expect_none(CubeLight(kSize), "black");
  expect_none(uniform, "uniform");
  expect_none(uneven_sky(kSize), "uneven");
  expect_none(builtin_environment("studio").project(kSize), "studio");
  expect_none(builtin_environment("cathedral").project(kSize), "cathedral");
  const Vec3d bright(5000, 5000, 5000);
  expect_none(with_disc(uneven_sky(kSize), {1, 1, 0}, 9 * kDegree, bright), "a wide lamp");
  expect_none(with_disc(with_disc(uneven_sky(kSize), {0, 1, 0}, kDegree, bright),
                        {std::sin(5 * kDegree), std::cos(5 * kDegree), 0}, kDegree, bright),
              "two lamps side by side");
  expect_none(with_disc(uneven_sky(kSize), {1, 1, 0}, kDegree, {300, 300, 300}), "a faint one");
  EXPECT_TRUE(split_sun(with_disc(uneven_sky(kSize), {1, 1, 0}, kDegree, {1500, 1500, 1500})).sun);
}

TEST(SplitSun, TheSunOfSunnyIsWhereItWasPut) {
  const auto [sky, sun] = split_sun(builtin_environment("sunny").project(256));
  ASSERT_TRUE(sun);
  EXPECT_NEAR(std::asin(sun->direction.y) / kDegree, 39.9, 0.1);
  EXPECT_NEAR(sun->angular_radius / kDegree, 0.3, 0.2);  // the picture's pixels have 0.35
}

TEST(SplitSun, RealProbesWithAndWithout) {
  const auto data = test::real_data();
  if (!data) GTEST_SKIP() << "RIMLIGHT_DATA names no real data";
  const auto has_sun = [&](const char* file) {
    return split_sun(load_environment(*data / "probes" / file).project(kSize)).sun.has_value();
  };
  EXPECT_TRUE(has_sun("rooitou_park_1k.hdr"));
  EXPECT_FALSE(has_sun("uffizi_latlong.hdr"));
  EXPECT_FALSE(has_sun("grace_latlong.exr"));
}

}  // namespace
}  // namespace rimlight
