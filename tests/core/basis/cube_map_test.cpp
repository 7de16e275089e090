#include "core/basis/cube_map.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "core/math/random.h"
#include "core/math/sampling.h"

namespace rimlight {
namespace {

constexpr std::array kBorders = {cube::Border::right, cube::Border::left, cube::Border::top,
                                 cube::Border::bottom};

TEST(CubeMap, FacesAreRightHanded) {
  for (int face = 0; face < cube::kFaces; ++face) {
    const cube::FaceAxes& axes = cube::face_axes(face);
    EXPECT_EQ(cross(axes.right, axes.up), axes.axis) << face;
  }
}

TEST(CubeMap, FacePointAndDirectionAreInverseOfEachOther) {
  Random random(11);
  double worst = 0;
  for (int i = 0; i < 10000; ++i) {
    const Vec3d direction = uniform_sphere(random_sample(random));
    const cube::FacePoint point = cube::face_point(direction * random.uniform(1e-3, 1e3));
    ASSERT_LE(std::abs(point.x), 1);
    ASSERT_LE(std::abs(point.y), 1);
    worst = std::max(worst, length(cube::direction(point) - direction));
  }
  EXPECT_LE(worst, 1e-15 * 4);
}

TEST(CubeMap, ATexelsMiddleFallsIntoTheTexel) {
  for (const int size : {1, 2, 7, 64}) {
    for (std::size_t t = 0; t < cube::texel_count(size); ++t) {
      ASSERT_EQ(cube::texel_of(cube::texel_direction(t, size), size), t) << "size " << size;
    }
  }
}

TEST(CubeMap, SolidAnglesSumToTheSphere) {
  for (const int size : {1, 2, 3, 16, 128}) {
    double sum = 0;
    for (std::size_t t = 0; t < cube::texel_count(size); ++t) {
      sum += cube::texel_solid_angle(t, size);
    }
    EXPECT_NEAR(sum, 4 * std::numbers::pi, 1e-10) << "size " << size;
  }
}

TEST(CubeMap, SolidAnglesAreTheShareOfUniformDirections) {
  const int size = 4;
  const int count = 400000;
  std::array<int, 96> hits{};
  Random random(12);
  for (int i = 0; i < count; ++i) {
    ++hits[cube::texel_of(uniform_sphere(random_sample(random)), size)];
  }
  for (std::size_t t = 0; t < hits.size(); ++t) {
    const double share = cube::texel_solid_angle(t, size) / (4 * std::numbers::pi);
    // 5σ of the binomial: one of 96 beyond it by chance in 10⁴ seeds
    EXPECT_NEAR(hits[t] / static_cast<double>(count), share, 5 * std::sqrt(share / count)) << t;
  }
}

TEST(CubeMap, FloatSolidAnglesAreTheRoundedOnes) {
  const AlignedVector<float> angles = cube::texel_solid_angles(8);
  ASSERT_EQ(angles.size(), cube::texel_count(8));
  for (std::size_t t = 0; t < angles.size(); ++t) {
    EXPECT_EQ(angles[t], static_cast<float>(cube::texel_solid_angle(t, 8)));
  }
}

TEST(CubeMap, TheTexelBeyondABorderSharesAnEdgeAndComesBack) {
  for (const int size : {2, 3, 16, 128}) {
    for (int face = 0; face < cube::kFaces; ++face) {
      std::set<std::size_t> met;
      for (const cube::Border border : kBorders) {
        for (int i = 0; i < size; ++i) {
          const bool sideways = border == cube::Border::right || border == cube::Border::left;
          const double edge = border == cube::Border::right || border == cube::Border::top ? 1 : -1;
          const double along = (2.0 * i + 1) / size - 1;
          // The edge they share, seen a hair from either side.
          const Vec3d on_edge = cube::direction(sideways ? cube::FacePoint{face, edge, along}
                                                         : cube::FacePoint{face, along, edge});
          const Vec3d axis = cube::face_axes(face).axis;
          const std::size_t beyond = cube::texel_beyond(face, border, i, size);
          ASSERT_EQ(cube::texel_of(on_edge - axis * 1e-9, size), beyond);
          ASSERT_NE(static_cast<int>(beyond) / (size * size), face);
          met.insert(beyond);
        }
      }
      EXPECT_EQ(met.size(), 4u * static_cast<std::size_t>(size));
    }
  }
}

}  // namespace
}  // namespace rimlight
