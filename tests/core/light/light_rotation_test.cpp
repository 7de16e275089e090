#include "core/light/light_rotation.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <iostream>

#include "core/base/check.h"
#include "core/light/environment.h"
#include "tests/core/light/light_samples.h"

namespace rimlight {
namespace {

/// What the rotation promises: relative error of ∫L dω, and of a uniform light at every texel.
constexpr double kPromise = 1e-3;
/// In texels, of a lit texel's centroid.
constexpr double kCentroidPromise = 0.1;

/// Rotations that put corners and borders exactly on corners and borders, and nearly so.
std::vector<Quaternion> awkward_rotations() {
  std::vector<Quaternion> result;
  for (const Vec3d& axis : {Vec3d{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 1, 1}}) {
    for (const double degrees : {1e-7, 1e-3, 45.0, 60.0, 90.0, 90.0001, 120.0, 180.0, 359.9999}) {
      result.push_back(axis_angle(axis, degrees * std::numbers::pi / 180));
    }
  }
  return result;
}

/// The worst relative error of ∫L dω over the rotations, awkward ones included.
double worst_energy_error(const CubeLight& light, int rotations, std::uint64_t seed) {
  LightRotator rotator(light);
  CubeLight target;
  const Vec3d truth = energy_of(light);
  double worst = 0;
  const auto turn = [&](const Quaternion& rotation) {
    rotator.rotate(rotation, target);
    worst = std::max(worst, relative_difference(energy_of(target), truth));
  };
  Random random(seed);
  for (int i = 0; i < rotations; ++i) turn(random_rotation(random));
  for (const Quaternion& rotation : awkward_rotations()) turn(rotation);
  return worst;
}

/// 1,000 at the sizes where they are cheap.
int rotations_at(int size) { return size <= 32 ? 1000 : size == 64 ? 100 : 20; }

TEST(LightRotation, KeepsTheEnergyOfEveryBuiltInEnvironment) {
  for (const std::string& name : builtin_environment_names()) {
    const Environment environment = builtin_environment(name);
    for (const int size : {16, 32, 64}) {
      const double worst = worst_energy_error(environment.project(size), rotations_at(size), 21);
      std::cout << name << " at " << size << ": worst energy error " << worst << "\n";
      EXPECT_LE(worst, kPromise) << name << ", size " << size;
    }
  }
}

TEST(LightRotation, KeepsTheEnergyOfRandomLights) {
  Random random(22);
  for (const int size : {2, 4, 8, 16, 32, 64, 128}) {
    const CubeLight light = random_light(size, random);
    EXPECT_LE(worst_energy_error(light, rotations_at(size), 23), kPromise) << "size " << size;
  }
}

TEST(LightRotation, KeepsTheEnergyOfCheckerboards) {
  for (const int size : {16, 32, 64, 128}) {
    for (const int width : {1, 2, 5}) {
      EXPECT_LE(worst_energy_error(checkerboard(size, width), rotations_at(size) / 4, 24), kPromise)
          << "size " << size << ", squares of " << width;
    }
  }
}

/// A texel just under the cap among black ones is the hardest for the overlap weights alone: a
/// sixteenth of the texels carries all energy.
TEST(LightRotation, KeepsTheEnergyOfSparseLightsBelowTheCap) {
  for (const int size : {8, 16, 32, 64}) {
    Random random(25);
    CubeLight light(size);
    for (std::size_t i = 0; i < light.count() / 15; ++i) {
      const auto texel = static_cast<std::size_t>(random.below(light.count()));
      for (int c = 0; c < 3; ++c) light.channel(c)[texel] = 1;
    }
    EXPECT_LE(worst_energy_error(light, rotations_at(size) / 4, 26), kPromise) << "size " << size;
  }
}

/// Face corners, edges, middles, and random ones.
std::vector<std::size_t> telling_texels(int size, int random_ones) {
  std::vector<std::size_t> texels;
  const int last = size - 1, half = size / 2;
  for (int face = 0; face < cube::kFaces; ++face) {
    for (const auto& [row, column] : std::vector<std::pair<int, int>>{
             {0, 0}, {0, last}, {last, last}, {half, half}, {0, half}, {half, last}}) {
      texels.push_back(texel_at(size, face, row, column));
    }
  }
  Random random(27);
  for (int i = 0; i < random_ones; ++i) {
    texels.push_back(static_cast<std::size_t>(random.below(cube::texel_count(size))));
  }
  return texels;
}

TEST(LightRotation, ALitTexelKeepsItsEnergyAndItsPlace) {
  for (const int size : {16, 32, 64, 128}) {
    Random random(28);
    double worst_energy = 0, worst_place = 0;
    int turns = 0;
    for (const std::size_t texel : telling_texels(size, size <= 32 ? 64 : 14)) {
      const CubeLight light = lit_texel(size, texel, 1e4f);
      LightRotator rotator(light);
      CubeLight target;
      for (int i = 0; i < (size <= 32 ? 10 : 3); ++i, ++turns) {
        const Quaternion rotation = random_rotation(random);
        rotator.rotate(rotation, target);
        worst_energy =
            std::max(worst_energy, relative_difference(energy_of(target), energy_of(light)));
        const Vec3d place = rotated(rotation, first_moment(light, 0));
        const double width = std::sqrt(cube::texel_solid_angle(cube::texel_of(place, size), size));
        worst_place = std::max(worst_place, angle_between(first_moment(target, 0), place) / width);
      }
    }
    std::cout << "size " << size << ": " << turns << " turns, worst energy error " << worst_energy
              << ", worst centroid " << worst_place << " texels\n";
    EXPECT_LE(worst_energy, kPromise) << "size " << size;
    EXPECT_LE(worst_place, kCentroidPromise) << "size " << size;
  }
}

TEST(LightRotation, AUniformLightStaysUniformAtEveryTexel) {
  for (const int size : {2, 4, 8, 16, 32, 64, 128}) {
    LightRotator rotator(uniform_light(size, 3));
    const CubeLight& source = rotator.source();
    CubeLight target;
    double worst = 0;
    const auto turn = [&](const Quaternion& rotation) {
      rotator.rotate(rotation, target);
      ASSERT_EQ(target.values.size(), source.values.size());
      for (std::size_t i = 0; i < target.values.size(); ++i) {
        worst = std::max(worst, std::abs(static_cast<double>(target.values[i]) /
                                             static_cast<double>(source.values[i]) -
                                         1));
      }
    };
    Random random(29);
    for (int i = 0; i < rotations_at(size); ++i) turn(random_rotation(random));
    for (const Quaternion& rotation : awkward_rotations()) turn(rotation);
    std::cout << "size " << size << ": worst departure from uniform " << worst << "\n";
    EXPECT_LE(worst, kPromise) << "size " << size;
  }
}

/// A step moves at most this share of a light's energy: a bilinear weight changes by 1/width along
/// each axis, so all four together by at most 4/width in sum; overlaps less. Widths are those of
/// the narrowest texel across, 1/3 of a middle one; and as much again for the pieces' density.
double step_bound(double angle, int size) { return 8 * angle / (2.0 / size / 3); }

TEST(LightRotation, EnergyMovesContinuouslyAcrossEdgesAndVertices) {
  constexpr int kSize = 16;
  constexpr int kSteps = 1500;
  // From a face's middle over a vertex, over an edge's end and middle, and along an edge.
  const std::array<std::pair<Vec3d, Vec3d>, 4> paths = {{{{0.2, 0.3, 1}, {1.4, 1.3, 0.9}},
                                                         {{0.9, 0.9, 1}, {1, 0.85, 0.2}},
                                                         {{0.1, 0.2, 1}, {1, 0.1, 0.3}},
                                                         {{0.99, -1, 1}, {1.01, 1, 1}}}};
  const std::size_t texel = texel_at(kSize, 4, 8, 8);
  const Vec3d home = cube::texel_direction(texel, kSize);
  Random random(30);
  for (const CubeLight& light : {lit_texel(kSize, texel), random_light(kSize, random)}) {
    LightRotator rotator(light);
    for (const auto& [from, to] : paths) {
      const Vec3d turn_to_start = cross(home, normalized(from));
      const Quaternion start = axis_angle(turn_to_start, angle_between(home, from));
      const double step = angle_between(from, to) / kSteps;
      CubeLight previous, target;
      double worst = 0;
      rotator.rotate(start, previous);
      for (int i = 1; i <= kSteps; ++i) {
        rotator.rotate(axis_angle(cross(from, to), step * i) * start, target);
        worst = std::max(worst, moved_energy(previous, target, 0));
        std::swap(previous, target);
      }
      EXPECT_LE(worst, step_bound(step, kSize) + 1e-5) << "towards " << to.x << " " << to.y;
      EXPECT_GT(worst, 0);
    }
  }
}

TEST(LightRotation, AHundredthOfTheStepMovesAHundredthOfTheEnergy) {
  constexpr int kSize = 32;
  Random random(31);
  for (int i = 0; i < 100; ++i) {
    const auto texel = static_cast<std::size_t>(random.below(cube::texel_count(kSize)));
    LightRotator rotator(lit_texel(kSize, texel));
    const Quaternion rotation = random_rotation(random);
    const Vec3d axis = rotated(rotation, {0, 0, 1});
    CubeLight before, after;
    rotator.rotate(rotation, before);
    for (const double angle : {1e-3, 1e-4}) {
      rotator.rotate(axis_angle(axis, angle) * rotation, after);
      ASSERT_LE(moved_energy(before, after, 0), step_bound(angle, kSize) + 1e-5) << angle;
    }
  }
}

TEST(LightRotation, TheIdentityGivesTheSourceBitForBit) {
  Random random(32);
  const CubeLight light = random_light(16, random);
  LightRotator rotator(light);
  CubeLight target;
  for (const double w : {1.0, -1.0}) {
    rotator.rotate({0, 0, 0, w}, target);
    ASSERT_EQ(target.size, 16);
    ASSERT_EQ(target.values.size(), light.values.size());
    EXPECT_EQ(
        std::memcmp(target.values.data(), light.values.data(), light.values.size() * sizeof(float)),
        0);
  }
}

TEST(LightRotation, QuarterTurnsPermuteTheTexels) {
  constexpr int kSize = 32;
  Random random(33);
  const CubeLight light = random_light(kSize, random);
  LightRotator rotator(light);
  CubeLight target;
  for (const Vec3d& axis : {Vec3d{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
    for (int quarters = 1; quarters < 4; ++quarters) {
      const Quaternion rotation = axis_angle(axis, quarters * std::numbers::pi / 2);
      rotator.rotate(rotation, target);
      for (std::size_t texel = 0; texel < light.count(); ++texel) {
        const Vec3d to = rotated(rotation, cube::texel_direction(texel, kSize));
        for (int c = 0; c < 3; ++c) {
          // Corners are placed to 1e-5 texel, so that much of a neighbour of at most 1 leaks in.
          ASSERT_NEAR(target.channel(c)[cube::texel_of(to, kSize)], light.channel(c)[texel], 5e-5);
        }
      }
    }
  }
}

TEST(LightRotation, IsLinearBelowTheCap) {
  Random random(34);
  CubeLight a = random_light(16, random), b = random_light(16, random), sum(16);
  for (std::size_t i = 0; i < sum.values.size(); ++i) {
    sum.values[i] = 2 * a.values[i] + b.values[i];
  }
  const Quaternion rotation = random_rotation(random);
  CubeLight turned_a, turned_b, turned_sum;
  LightRotator(a).rotate(rotation, turned_a);
  LightRotator(b).rotate(rotation, turned_b);
  LightRotator(sum).rotate(rotation, turned_sum);
  for (std::size_t i = 0; i < sum.values.size(); ++i) {
    ASSERT_NEAR(turned_sum.values[i], 2 * turned_a.values[i] + turned_b.values[i], 1e-5);
  }
}

TEST(LightRotation, TurningBackAlwaysStartsFromTheSource) {
  Random random(35);
  LightRotator rotator(random_light(16, random));
  const Quaternion rotation = random_rotation(random);
  CubeLight first, again;
  rotator.rotate(rotation, first);
  for (int i = 0; i < 20; ++i) rotator.rotate(random_rotation(random), again);
  rotator.rotate(rotation, again);
  EXPECT_EQ(
      std::memcmp(first.values.data(), again.values.data(), first.values.size() * sizeof(float)),
      0);
}

TEST(LightRotation, IsFiniteAndNeverNegativeOverSixteenDecades) {
  Random random(36);
  CubeLight light(32);
  for (float& value : light.values) {
    value = static_cast<float>(std::pow(10.0, random.uniform(-8, 8)));
  }
  light.values[5] = 0;
  LightRotator rotator(light);
  CubeLight target;
  for (int i = 0; i < 100; ++i) {
    rotator.rotate(random_rotation(random), target);
    for (const float value : target.values) ASSERT_TRUE(std::isfinite(value) && value >= 0);
    ASSERT_LE(relative_difference(energy_of(target), energy_of(light)), kPromise);
  }
}

TEST(LightRotation, BlackStaysBlack) {
  LightRotator rotator(CubeLight(16));
  CubeLight target;
  rotator.rotate(axis_angle({1, 2, 3}, 1), target);
  for (const float value : target.values) ASSERT_EQ(value, 0);
}

TEST(LightRotation, RefusesWhatIsNoRotationAndNoLight) {
  LightRotator rotator(uniform_light(16));
  CubeLight target;
  EXPECT_THROW(rotator.rotate({0, 0, 0, 1.1}, target), CheckFailure);
  EXPECT_THROW(rotator.rotate({0, 0, 0, std::nan("")}, target), CheckFailure);
  for (const float bad : {-1.0f, std::nanf(""), INFINITY}) {
    CubeLight light = uniform_light(16);
    light.values[7] = bad;
    EXPECT_THROW(LightRotator{light}, CheckFailure);
  }
  CubeLight short_of_values = uniform_light(16);
  short_of_values.values.pop_back();
  EXPECT_THROW(LightRotator{short_of_values}, CheckFailure);
}

}  // namespace
}  // namespace rimlight
