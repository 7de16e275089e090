#include "core/light/soft_disc.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <vector>

#include "core/base/check.h"
#include "core/math/sampling.h"
#include "tests/core/light/light_samples.h"

namespace rimlight {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// w as the header defines it.
double coverage(const SoftDisc& disc, const Vec3d& direction) {
  const double cosine = std::cos(disc.angular_radius);
  const double low = cosine - disc.edge * (1 - cosine), high = cosine + disc.edge * (1 - cosine);
  const double z = dot(disc.direction, direction);
  if (!(low < high)) return z > cosine ? 1 : 0;
  const double u = std::clamp((z - low) / (high - low), 0.0, 1.0);
  return 3 * u * u - 2 * u * u * u;
}

/// The mean of w over a texel by n × n points.
double mean_coverage(const SoftDisc& disc, std::size_t texel, int size, int n) {
  const int index = static_cast<int>(texel);
  const int face = index / (size * size), row = index / size % size, column = index % size;
  double sum = 0, weight = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double x = 2 * (column + (i + 0.5) / n) / size - 1;
      const double y = 2 * (row + (j + 0.5) / n) / size - 1;
      const double density = std::pow(1 + x * x + y * y, -1.5);
      sum += density * coverage(disc, cube::direction({face, x, y}));
      weight += density;
    }
  }
  return sum / weight;
}

/// Face middles, edges, vertices, corners of texels, and a hair beside them; then random ones.
std::vector<Vec3d> telling_directions(int random_ones, std::uint64_t seed) {
  std::vector<Vec3d> result;
  for (const Vec3d& v : {Vec3d{1, 0, 0},
                         {0, -1, 0},
                         {1, 1, 0},
                         {0, 1, -1},
                         {1, 1, 1},
                         {-1, 1, -1},
                         {1, 0.5, 0.25},
                         {1, 0.5, 0},
                         {1, 1e-12, 0},
                         {1, 1 - 1e-12, 0.3},
                         {0.999999, 1, 1}}) {
    result.push_back(normalized(v));
  }
  Random random(seed);
  for (int i = 0; i < random_ones; ++i) result.push_back(uniform_sphere(random_sample(random)));
  return result;
}

std::vector<SoftDisc> telling_discs(int random_ones, std::uint64_t seed) {
  std::vector<SoftDisc> discs;
  for (const Vec3d& direction : telling_directions(random_ones, seed)) {
    for (const double degrees : {0.1, 1.0, 7.0, 30.0, 60.0}) {
      for (const double edge : {0.0, 1e-9, 0.3, 0.95, 1.0}) {
        discs.push_back({direction, degrees * kDegree, edge});
      }
    }
  }
  return discs;
}

/// Texels are floats: each is rounded by 6e-8 of itself, and so is their sum at most.
constexpr double kFloatRounding = 1e-7;

TEST(SoftDisc, ItsEnergyIsRadianceTimesSolidAngleWhereverItLies) {
  double worst = 0;
  int discs = 0;
  for (const int size : {2, 3, 4, 8, 16, 33, 64}) {
    for (const SoftDisc& disc : telling_discs(size <= 16 ? 40 : 10, 71)) {
      CubeLight light(size);
      const Vec3d radiance{2, 5, 0.25};
      add_disc(disc, radiance, light);
      const double error = relative_difference(energy_of(light), radiance * solid_angle(disc));
      EXPECT_LE(error, kFloatRounding)
          << "size " << size << ", radius " << disc.angular_radius << ", edge " << disc.edge;
      worst = std::max(worst, error);
      ++discs;
    }
  }
  std::cout << discs << " discs, worst energy error " << worst << "\n";
}

TEST(SoftDisc, ItsSolidAngleIsThatOfTheSharpDisc) {
  // ∫ w dω = 2π ∫ w dz by 100,000 steps.
  for (const double edge : {0.0, 0.4, 1.0}) {
    const SoftDisc disc{{0, 0, 1}, 40 * kDegree, edge};
    constexpr int kSteps = 100'000;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
      const double z = 2 * (i + 0.5) / kSteps - 1;
      sum += coverage(disc, {std::sqrt(1 - z * z), 0, z});
    }
    EXPECT_NEAR(4 * std::numbers::pi * sum / kSteps, solid_angle(disc), 2e-4);
    EXPECT_NEAR(solid_angle(disc), 2 * std::numbers::pi * (1 - std::cos(40 * kDegree)), 1e-12);
  }
}

TEST(SoftDisc, EveryTexelGetsTheMeanOverItself) {
  constexpr int kPoints = 48;
  Random random(72);
  double worst_sharp = 0, worst_soft = 0;
  int partly = 0;
  for (const int size : {2, 5, 8}) {
    for (const Vec3d& direction : telling_directions(4, 73)) {
      for (const double edge : {0.0, 0.5, 1.0}) {
        const SoftDisc disc{direction, random.uniform(2, 60) * kDegree, edge};
        CubeLight light(size);
        add_disc(disc, {1, 1, 1}, light);
        for (std::size_t texel = 0; texel < light.count(); ++texel) {
          const double truth = mean_coverage(disc, texel, size, kPoints);
          const double error = std::abs(static_cast<double>(light.values[texel]) - truth);
          (edge > 0 ? worst_soft : worst_sharp) =
              std::max(edge > 0 ? worst_soft : worst_sharp, error);
          partly += truth > 0 && truth < 1;
        }
      }
    }
  }
  std::cout << partly << " texels on an edge; worst error " << worst_sharp << " where sharp, "
            << worst_soft << " where soft\n";
  EXPECT_GT(partly, 1000);
  // The points are the coarse side: a border of length 3 texels crosses up to 3n of n² points, each
  // in doubt by less than a half of its share, mostly with random signs.
  EXPECT_LE(worst_sharp, 0.5 / kPoints);
  EXPECT_LE(worst_soft, 8.0 / (kPoints * kPoints));
}

/// Quadrature on the soft edge may move energy between neighbours, which the total does not show:
/// 16 pieces of a border against one.
TEST(SoftDisc, ATexelGetsWhatItsPartsGetOnAFinerMap) {
  constexpr int kCoarse = 4, kFactor = 16, kFine = kCoarse * kFactor;
  double worst = 0;
  for (const SoftDisc& disc : telling_discs(20, 78)) {
    CubeLight coarse(kCoarse), fine(kFine);
    add_disc(disc, {1, 1, 1}, coarse);
    add_disc(disc, {1, 1, 1}, fine);
    std::vector<double> energy(coarse.count());
    for (std::size_t texel = 0; texel < fine.count(); ++texel) {
      energy[cube::texel_of(cube::texel_direction(texel, kFine), kCoarse)] +=
          static_cast<double>(fine.values[texel]) * texel_geometry(kFine).solid_angle[texel];
    }
    for (std::size_t texel = 0; texel < coarse.count(); ++texel) {
      const double whole = texel_geometry(kCoarse).solid_angle[texel];
      worst = std::max(worst,
                       std::abs(static_cast<double>(coarse.values[texel]) - energy[texel] / whole));
    }
  }
  std::cout << "worst difference " << worst << " of a full texel\n";
  EXPECT_LE(worst, 1e-6);
}

TEST(SoftDisc, ASoftDiscWithinOneTexelIsThatTexelsAlone) {
  for (const double edge : {0.0, 0.5, 1.0}) {
    for (const int size : {8, 9}) {
      for (int row = 0; row < size; ++row) {
        const std::size_t texel = texel_at(size, 3, row, size / 3);
        const SoftDisc disc{cube::texel_direction(texel, size), 1.5 * kDegree, edge};
        CubeLight light(size);
        add_disc(disc, {1, 1, 1}, light);
        const double share = solid_angle(disc) / cube::texel_solid_angle(texel, size);
        for (std::size_t i = 0; i < light.count(); ++i) {
          ASSERT_NEAR(light.values[i], i == texel ? share : 0, 1e-8) << row << " " << edge;
        }
      }
    }
  }
}

TEST(SoftDisc, LeavesAloneWhatItDoesNotTouch) {
  constexpr int kSize = 32;
  Random random(74);
  const CubeLight before = random_light(kSize, random);
  const TexelGeometry& texels = texel_geometry(kSize);
  for (const SoftDisc& disc : telling_discs(10, 75)) {
    CubeLight after = before;
    add_disc(disc, {1, 1, 1}, after);
    const double reach =
        std::acos(1 - (1 - std::cos(disc.angular_radius)) * (1 + disc.edge)) + 2.0 / kSize;
    std::size_t changed = 0;
    for (std::size_t texel = 0; texel < before.count(); ++texel) {
      if (before.at(texel) == after.at(texel)) continue;
      ++changed;
      ASSERT_LE(angle_between(disc.direction, texels.direction[texel]), reach);
      ASSERT_GE(after.values[texel], before.values[texel]);
    }
    EXPECT_GE(changed, 1u);
  }
}

TEST(SoftDisc, IsBrightInTheMiddleAndNeverBrighterThanItsRadiance) {
  for (const SoftDisc& disc : telling_discs(10, 76)) {
    CubeLight light(16);
    add_disc(disc, {3, 0, 1}, light);
    for (const float value : light.channel(0)) ASSERT_TRUE(value >= 0 && value <= 3);
    for (const float value : light.channel(1)) ASSERT_EQ(value, 0);
    if (disc.angular_radius > 25 * kDegree && disc.edge < 0.5) {
      EXPECT_EQ(light.channel(0)[cube::texel_of(disc.direction, 16)], 3.0f);
    }
  }
}

TEST(SoftDisc, AQuarterTurnOfTheDiscPermutesTheTexels) {
  constexpr int kSize = 12;
  for (const SoftDisc& disc : telling_discs(5, 77)) {
    CubeLight light(kSize), turned_light(kSize);
    add_disc(disc, {1, 1, 1}, light);
    const auto turned = [](const Vec3d& v) { return Vec3d{v.y, v.z, v.x}; };
    add_disc({turned(disc.direction), disc.angular_radius, disc.edge}, {1, 1, 1}, turned_light);
    for (std::size_t texel = 0; texel < light.count(); ++texel) {
      const std::size_t to = cube::texel_of(turned(cube::texel_direction(texel, kSize)), kSize);
      ASSERT_NEAR(turned_light.values[to], light.values[texel], 1e-7);
    }
  }
}

TEST(SoftDisc, MovesAndGrowsWithoutJumps) {
  constexpr int kSize = 16;
  constexpr int kSteps = 2000;
  for (const double edge : {0.0, 0.5}) {
    CubeLight previous(kSize);
    double worst = 0;
    for (int i = 0; i <= kSteps; ++i) {
      // From a face over an edge and a vertex, from 5 to 25 degrees.
      const double t = static_cast<double>(i) / kSteps;
      const Vec3d direction = normalized(Vec3d{1, t * 1.2, t * 1.1});
      CubeLight light(kSize);
      add_disc({direction, (5 + 20 * t) * kDegree, edge}, {1, 1, 1}, light);
      if (i > 0) worst = std::max(worst, moved_energy(previous, light, 0));
      previous = light;
    }
    // A step moves the border by at most 1.5 radians / kSteps, twice over; at 5 degrees that is
    // this share of the disc.
    EXPECT_LE(worst, 4 * 1.5 / kSteps / (5 * kDegree));
    EXPECT_GT(worst, 0);
  }
}

TEST(SoftDisc, RefusesWhatIsNoDisc) {
  CubeLight light(8), tiny(1);
  const SoftDisc good{{0, 1, 0}, 0.1, 0};
  EXPECT_NO_THROW(add_disc(good, {1, 1, 1}, light));
  EXPECT_THROW(add_disc(good, {1, 1, 1}, tiny), CheckFailure);
  const double nan = std::nan("");
  for (const SoftDisc& bad :
       {SoftDisc{{0, 2, 0}, 0.1, 0}, SoftDisc{{0, nan, 0}, 0.1, 0}, SoftDisc{{0, 1, 0}, 0, 0},
        SoftDisc{{0, 1, 0}, 1.1, 0}, SoftDisc{{0, 1, 0}, nan, 0}, SoftDisc{{0, 1, 0}, 0.1, 1.1},
        SoftDisc{{0, 1, 0}, 0.1, nan}}) {
    EXPECT_THROW(add_disc(bad, {1, 1, 1}, light), CheckFailure);
  }
}

}  // namespace
}  // namespace rimlight
