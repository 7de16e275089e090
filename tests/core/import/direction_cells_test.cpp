// Spherical Voronoi cells against closed forms, brute force and counting nearest directions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/base/parallel.h"
#include "core/import/direction_cells.h"
#include "core/math/rotation.h"
#include "tests/core/import/direction_sets.h"
#include "tests/support/reference/spherical_overlap.h"

namespace rimlight {
namespace {

constexpr double kSphere = 4 * std::numbers::pi;

std::vector<double> cell_areas(const std::vector<Vec3d>& directions, int size = 8,
                               const SphericalCap& cap = {}) {
  const DirectionCells cells(directions, size, cap);
  EXPECT_EQ(cells.direction_count(), directions.size());
  std::vector<double> areas;
  for (std::size_t i = 0; i < directions.size(); ++i) areas.push_back(cells.solid_angle(i));
  return areas;
}

double sum(const std::vector<double>& values) {
  double result = 0;
  for (const double value : values) result += value;
  return result;
}

/// Corners of Platonic solids.
std::vector<Vec3d> octahedron() {
  return {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
}
std::vector<Vec3d> cube_corners() {
  std::vector<Vec3d> corners;
  for (int i = 0; i < 8; ++i) {
    corners.push_back(normalized(Vec3d(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  }
  return corners;
}
std::vector<Vec3d> icosahedron() {
  std::vector<Vec3d> corners;
  for (int i = 0; i < 4; ++i) {
    const double a = i & 1 ? 1 : -1, b = (i & 2 ? 1 : -1) * std::numbers::phi;
    for (const Vec3d& p : {Vec3d(0, a, b), Vec3d(a, b, 0), Vec3d(b, 0, a)}) {
      corners.push_back(normalized(p));
    }
  }
  return corners;
}

/// Each direction's cell as a spherical polygon on each face of the cube: clipped by every
/// bisector.
std::vector<double> brute_force_areas(const std::vector<Vec3d>& directions) {
  std::vector<double> areas;
  for (const Vec3d& one : directions) {
    double area = 0;
    for (std::size_t face = 0; face < 6; ++face) {
      reference::SphericalPolygon polygon = reference::texel_outline(face, 1);
      for (const Vec3d& other : directions) {
        if (&other == &one || polygon.empty()) continue;
        // A triangle whose first side's plane is the bisector; the others lie far outside.
        const Vec3d normal = normalized(one - other);
        const Frame<double> frame(normal);
        reference::SphericalPolygon kept;
        for (std::size_t k = 0; k < polygon.size(); ++k) {
          const Vec3d &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
          const double da = dot(a, normal), db = dot(b, normal);
          if (da >= 0) kept.push_back(a);
          if ((da > 0 && db < 0) || (da < 0 && db > 0)) {
            kept.push_back(a * (db / (db - da)) + b * (da / (da - db)));
          }
        }
        polygon = kept;
      }
      if (polygon.size() >= 3) area += reference::solid_angle(polygon);
    }
    areas.push_back(area);
  }
  return areas;
}

TEST(DirectionCells, FewDirectionsHaveTheirClosedForms) {
  EXPECT_NEAR(cell_areas({normalized(Vec3d(1, 2, 3))})[0], kSphere, 1e-12);
  for (const double area : cell_areas({{0, 0, 1}, {0.6, 0.8, 0}})) {
    EXPECT_NEAR(area, kSphere / 2, 1e-12);
  }
  // On one great circle: lunes, of the angle between the bisectors.
  const auto at = [](double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    return Vec3d(std::cos(angle), 0, std::sin(angle));
  };
  const auto lunes = cell_areas({at(10), at(70), at(200)});
  const double per_degree = kSphere / 360;
  EXPECT_NEAR(lunes[0], 115 * per_degree, 1e-12);
  EXPECT_NEAR(lunes[1], 95 * per_degree, 1e-12);
  EXPECT_NEAR(lunes[2], 150 * per_degree, 1e-12);
}

TEST(DirectionCells, PlatonicCornersShareTheSphereEquallyInAnyRotation) {
  Random random(5);
  for (const auto& solid : {octahedron(), cube_corners(), icosahedron()}) {
    for (int turn = 0; turn < 4; ++turn) {
      const Quaternion rotation = turn == 0 ? Quaternion{} : random_rotation(random);
      std::vector<Vec3d> corners;
      for (const Vec3d& corner : solid) corners.push_back(rotated(rotation, corner));
      const auto areas = cell_areas(corners);
      const double expected = kSphere / static_cast<double>(solid.size());
      for (const double area : areas) EXPECT_NEAR(area, expected, 1e-12);
    }
  }
}

TEST(DirectionCells, AgreeWithBruteForce) {
  struct Case {
    const char* name;
    std::vector<Vec3d> directions;
  };
  std::vector<Vec3d> clustered = random_cap(60, {0.6, 0, 0.8}, 0.05, 8);
  for (const Vec3d& one : random_directions(20, 9)) clustered.push_back(one);
  for (const Case& one :
       {Case{"random", random_directions(150, 7)}, Case{"clustered", clustered},
        Case{"cap only", random_cap(50, {0, 1, 0}, 0.4, 3)}, Case{"texels", texel_directions(4)},
        Case{"grid", grid_directions(6, 13)}}) {
    const auto expected = brute_force_areas(one.directions);
    const auto areas = cell_areas(one.directions);
    double worst = 0;
    for (std::size_t i = 0; i < areas.size(); ++i) {
      worst = std::max(worst, std::abs(areas[i] - expected[i]));
    }
    std::printf("%s: worst difference %.2g sr\n", one.name, worst);
    EXPECT_LT(worst, 1e-12) << one.name;
  }
}

TEST(DirectionCells, AreasAreTheOddsOfBeingNearest) {
  const auto directions = random_directions(40, 21);
  const auto areas = cell_areas(directions);
  constexpr int kSamples = 400'000;
  std::vector<int> counts(directions.size());
  Random random(22);
  for (int i = 0; i < kSamples; ++i) {
    const Vec3d point = uniform_sphere(random_sample(random));
    const auto best = std::max_element(
        directions.begin(), directions.end(),
        [&](const Vec3d& a, const Vec3d& b) { return dot(a, point) < dot(b, point); });
    ++counts[static_cast<std::size_t>(best - directions.begin())];
  }
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const double odds = areas[i] / kSphere;
    const double deviation = std::sqrt(odds * (1 - odds) * kSamples);
    // Six standard errors in one of 40 cells: a chance of 1e-7.
    EXPECT_LT(std::abs(counts[i] - odds * kSamples), 6 * deviation) << i;
  }
}

TEST(DirectionCells, SumToTheSphereAndToEachTexel) {
  for (const int size : {1, 2, 16}) {
    for (const int count : {1, 3, 30, 1000, 20'000}) {
      const auto directions = random_directions(count, 100 + static_cast<std::uint64_t>(count));
      const DirectionCells cells(directions, size);
      std::vector<double> texels(cube::texel_count(size));
      for (std::size_t i = 0; i < directions.size(); ++i) {
        std::uint32_t previous = 0;
        for (const DirectionCells::Share& share : cells.shares(i)) {
          EXPECT_GT(share.solid_angle, 0);
          EXPECT_TRUE(&share == cells.shares(i).data() || share.texel > previous);
          previous = share.texel;
          texels[share.texel] += share.solid_angle;
        }
      }
      EXPECT_NEAR(sum(texels), kSphere, 1e-10);
      for (std::size_t texel = 0; texel < texels.size(); ++texel) {
        EXPECT_NEAR(texels[texel], cube::texel_solid_angle(texel, size), 1e-12);
      }
    }
  }
}

TEST(DirectionCells, DoNotDependOnTheCubeMapOrOnThreads) {
  const auto directions = random_directions(500, 31);
  const auto coarse = cell_areas(directions, 1);
  for (const int size : {4, 64}) {
    const auto fine = cell_areas(directions, size);
    for (std::size_t i = 0; i < fine.size(); ++i) EXPECT_NEAR(fine[i], coarse[i], 1e-13);
  }
  set_thread_count(1);
  EXPECT_EQ(cell_areas(directions, 1), coarse);
  set_thread_count(0);
}

TEST(DirectionCells, AGridIsEvenAroundEachRing) {
  constexpr int kRows = 64, kColumns = 256;  // 256 cells meet at each pole
  const auto areas = cell_areas(grid_directions(kRows, kColumns), 16);
  EXPECT_NEAR(sum(areas), kSphere, 1e-10);
  for (int row = 0; row < kRows; ++row) {
    const auto ring = areas.begin() + row * kColumns;
    const auto [low, high] = std::minmax_element(ring, ring + kColumns);
    EXPECT_LT(*high - *low, 1e-11) << row;
    EXPECT_NEAR(*low, areas[static_cast<std::size_t>((kRows - 1 - row) * kColumns)], 1e-11);
  }
}

TEST(DirectionCells, CoincidentDirectionsShareOneCell) {
  auto directions = random_directions(30, 41);
  const auto once = cell_areas(directions);
  directions.push_back(directions[4]);
  directions.push_back(normalized(directions[4] + Vec3d(0, 1e-6, 0)));
  directions.insert(directions.begin(), directions[9]);
  const auto areas = cell_areas(directions);
  EXPECT_NEAR(sum(areas), kSphere, 1e-11);
  // One of the three nearly coincident stands for all: the cell moves by 1e-6.
  for (const std::size_t i : {5u, 31u, 32u}) EXPECT_NEAR(areas[i], once[4] / 3, 1e-5);
  for (const std::size_t i : {0u, 10u}) EXPECT_NEAR(areas[i], once[9] / 2, 1e-5);
  EXPECT_NEAR(areas[1], once[0], 1e-5);
}

TEST(DirectionCells, AHemisphereEndsAtItsRimExactly) {
  const Vec3d up(0, 1, 0);
  const SphericalCap upper{up, std::numbers::pi / 2};
  auto directions = random_cap(80, up, std::numbers::pi / 2, 51);
  const auto half = cell_areas(directions, 8, upper);
  EXPECT_NEAR(sum(half), kSphere / 2, 1e-11);
  // With its mirror image below, a full sphere's cells end at the same rim.
  const std::size_t count = directions.size();
  for (std::size_t i = 0; i < count; ++i) {
    directions.emplace_back(directions[i].x, -directions[i].y, directions[i].z);
  }
  const auto whole = cell_areas(directions);
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_NEAR(half[i], whole[i], 1e-12);
    EXPECT_NEAR(whole[count + i], whole[i], 1e-12);
  }
}

TEST(DirectionCells, ACapKeepsItsSolidAngle) {
  for (const double degrees : {3.0, 25.0, 110.0, 170.0}) {
    const double angle = degrees * std::numbers::pi / 180;
    const Vec3d axis = normalized(Vec3d(1, 2, -0.5));
    const SphericalCap cap{axis, angle};
    EXPECT_NEAR(cap.solid_angle(), 2 * std::numbers::pi * (1 - std::cos(angle)), 1e-12);
    const auto areas = cell_areas(random_cap(40, axis, angle, 61), 16, cap);
    EXPECT_NEAR(sum(areas) / cap.solid_angle(), 1, 1e-6) << degrees;
    for (const double area : areas) EXPECT_GT(area, 0);
  }
}

TEST(DirectionCells, ManyInALineOrAClusterAreCutToo) {
  std::vector<Vec3d> line;
  for (int i = 0; i < 250; ++i) {
    line.push_back(normalized(Vec3d(1, i * 1.1 * kCoincident, 0)));  // thin lunes
  }
  EXPECT_NEAR(sum(cell_areas(line)), kSphere, 1e-9);
  EXPECT_NEAR(sum(cell_areas(random_cap(2000, {0, 0, 1}, 0.02, 71))), kSphere, 1e-9);
}

}  // namespace
}  // namespace rimlight
