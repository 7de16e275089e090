// Environments from the world, when the data is there: RIMLIGHT_DATA, or ../shared/data.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "core/light/environment.h"
#include "core/light/light_rotation.h"
#include "tests/core/light/light_samples.h"
#include "tests/support/real_data.h"

namespace rimlight {
namespace {

class RealProbes : public testing::Test {
 protected:
  void SetUp() override {
    const auto data = test::real_data();
    if (!data) GTEST_SKIP() << "RIMLIGHT_DATA names no real data";
    folder_ = *data / "probes";
  }

  Environment load(const char* name) const { return load_environment(folder_ / name); }

  std::filesystem::path folder_;
};

/// The same world turned about the vertical: columns moved by a share of the width.
RgbImage turned(const RgbImage& image, double share) {
  RgbImage result(image.width, image.height);
  const int shift = static_cast<int>(share * image.width);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      result.at(x, y) = image.at((x + shift) % image.width, y);
    }
  }
  return result;
}

RgbImage upside_down(const RgbImage& image, float scale) {
  RgbImage result(image.width, image.height);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      result.at(x, y) = image.at(x, image.height - 1 - y) * scale;
    }
  }
  return result;
}

/// ‖a − b‖₁ / ‖b‖₁ over the sphere, in green.
double difference(const CubeLight& a, const CubeLight& b) { return moved_energy(b, a, 1); }

TEST_F(RealProbes, EveryProbeKeepsItsEnergyWhenProjectedAndTurned) {
  int probes = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder_)) {
    const Environment environment = load_environment(file.path());
    const Vec3d truth = integral(environment);
    const CubeLight light = environment.project(64);
    EXPECT_LE(relative_difference(integral(light), truth), 1e-3) << environment.name();
    LightRotator rotator(light);
    CubeLight target;
    Random random(81);
    for (int i = 0; i < 20; ++i) {
      rotator.rotate(random_rotation(random), target);
      ASSERT_LE(relative_difference(integral(target), integral(light)), 1e-3) << environment.name();
    }
    ++probes;
  }
  EXPECT_GT(probes, 0);
}

TEST_F(RealProbes, GraceCathedralIsTheSameAsAngularMapAndLatLong) {
  const Environment probe = load("grace_probe.hdr");
  ASSERT_EQ(probe.layout(), EnvironmentLayout::angular_map);
  // Stored with the floor on top, and scaled.
  const Environment lat_long("grace", upside_down(load("grace_latlong.exr").image(), 31.98f),
                             EnvironmentLayout::lat_long);
  EXPECT_LE(difference(lat_long.project(16), probe.project(16)), 0.05);
  EXPECT_LE(relative_difference(integral(lat_long), integral(probe)), 0.02);
}

TEST_F(RealProbes, TheUffiziAreTheSameAsAngularMapAndLatLong) {
  const Environment probe = load("uffizi_angular_derived.hdr");
  // The lat-long image's middle looks a quarter turn away from the probe's.
  const Environment lat_long("uffizi", turned(load("uffizi_latlong.hdr").image(), 0.25),
                             EnvironmentLayout::lat_long);
  EXPECT_LE(difference(lat_long.project(16), probe.project(16)), 0.03);
  EXPECT_LE(relative_difference(integral(lat_long), integral(probe)), 0.01);
}

}  // namespace
}  // namespace rimlight
