#include "core/light/light_rotation_kernel.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <iostream>

#include "core/light/light_rotation.h"
#include "tests/core/light/light_samples.h"
#include "tests/support/reference/spherical_overlap.h"

namespace rimlight {
namespace {

/// Runs the test body on each SIMD target that this machine has.
template <typename Body>
void for_each_target(const Body& body) {
  int targets = 0;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::GetChosenTarget().Update(target);
    body();
    ++targets;
  }
  hwy::GetChosenTarget().DeInit();
  EXPECT_GT(targets, 0);
}

/// The mean of the source over each rotated texel, by exact spherical polygons in double.
std::vector<double> overlap_means(const CubeLight& source, const Quaternion& rotation) {
  const int size = source.size;
  const double reach = 2 * std::numbers::sqrt2 * 2 / size;  // two texels' diagonals at most
  std::vector<double> energy(source.count(), 0.0);
  for (std::size_t s = 0; s < source.count(); ++s) {
    const auto from = reference::rotated(rotation, reference::texel_outline(s, size));
    const Vec3d middle = rotated(rotation, cube::texel_direction(s, size));
    for (std::size_t t = 0; t < source.count(); ++t) {
      if (length(cube::texel_direction(t, size) - middle) > reach) continue;
      const double shared =
          reference::solid_angle(reference::clipped(from, reference::texel_outline(t, size)));
      energy[t] += shared * static_cast<double>(source.channel(0)[s]);
    }
  }
  for (std::size_t t = 0; t < energy.size(); ++t) energy[t] /= cube::texel_solid_angle(t, size);
  return energy;
}

TEST(SphericalOverlap, ReferenceSharesATexelOutWhole) {
  const auto rotation = axis_angle({1, 2, 3}, 0.7);
  for (const std::size_t s : {0u, 27u, 100u, 383u}) {
    const auto from = reference::rotated(rotation, reference::texel_outline(s, 8));
    double sum = 0;
    for (std::size_t t = 0; t < cube::texel_count(8); ++t) {
      if (dot(cube::texel_direction(t, 8), rotated(rotation, cube::texel_direction(s, 8))) < 0.5) {
        continue;
      }
      sum += reference::solid_angle(reference::clipped(from, reference::texel_outline(t, 8)));
    }
    EXPECT_NEAR(sum, cube::texel_solid_angle(s, 8), 1e-13);
  }
}

/// Of a texel's mean: ρ's third-order remainder about the cell's middle is at most 1.6·δ³ of ρ (the
/// largest of |∂³ρ|/6ρ), δ the distance in the plane, whose mean cube over a cell of side h =
/// 2/size is 0.08·h³. Corners are rounded to 5e-6 of a cell, on four sides.
double weight_bound(int size, double largest) {
  return (1.6 * 0.08 * std::pow(2.0 / size, 3) + 2e-5) * largest;
}

TEST(LightRotationKernel, OverlapsEqualSphericalPolygonsOnEveryTarget) {
  for (const int size : {16, 24}) {
    Random random(41);
    const CubeLight light = random_light(size, random);
    LightRotator rotator(light);
    for (const Quaternion& rotation :
         {random_rotation(random), random_rotation(random), axis_angle({0, 1, 0}, 0.01),
          axis_angle({1, 1, 1}, std::numbers::pi / 4)}) {
      const std::vector<double> truth = overlap_means(light, rotation);
      double worst = 0;
      for_each_target([&] {
        CubeLight target;
        rotator.rotate(rotation, target);
        for (std::size_t t = 0; t < truth.size(); ++t) {
          worst = std::max(worst, std::abs(static_cast<double>(target.channel(0)[t]) - truth[t]));
        }
      });
      std::cout << "size " << size << ": worst error of a texel " << worst << ", bound "
                << weight_bound(size, 1) << "\n";
      EXPECT_LE(worst, weight_bound(size, 1));
    }
  }
}

/// One quadrilateral in an otherwise empty batch, against the reference, cell by cell.
TEST(LightRotationKernel, CutsQuadrilateralsAtTheirBoxes) {
  constexpr int kSize = 32;
  const double h = 2.0 / kSize;
  Random random(42);
  for_each_target([&] {
    for (int trial = 0; trial < 200; ++trial) {
      OverlapBatch batch;
      batch.columns = 1 + static_cast<int>(random.below(kLargestOverlapSide));
      batch.rows = 1 + static_cast<int>(random.below(kLargestOverlapSide));
      batch.count = 1 + static_cast<std::size_t>(random.below(kOverlapLanes));
      const std::size_t lane = batch.count - 1;
      const int box_u = static_cast<int>(random.below(kSize - kLargestOverlapSide));
      const int box_v = static_cast<int>(random.below(kSize - kLargestOverlapSide));
      const double turn = random.uniform(0, 2 * std::numbers::pi), radius = random.uniform(0.3, 3);
      reference::SphericalPolygon quadrilateral;
      for (std::size_t i = 0; i < 4; ++i) {
        const double angle = turn + static_cast<double>(i) * std::numbers::pi / 2;
        const double u = 2 + radius * std::cos(angle), v = 2 + 0.7 * radius * std::sin(angle);
        batch.u[i][lane] = static_cast<float>(u);
        batch.v[i][lane] = static_cast<float>(v);
        quadrilateral.push_back({(box_u + u) * h - 1, (box_v + v) * h - 1, 1});
      }
      batch.box_u[lane] = static_cast<float>(box_u);
      batch.box_v[lane] = static_cast<float>(box_v);
      const std::size_t first = texel_at(kSize, 4, box_v, box_u);
      batch.first_texel[lane] = static_cast<std::uint32_t>(first);
      batch.radiance[lane][1] = 2;
      AlignedVector<float> energy(4 * cube::texel_count(kSize), 0.0f);
      add_overlaps(batch, kSize, energy);
      for (int j = 0; j < batch.rows; ++j) {
        for (int i = 0; i < batch.columns; ++i) {
          const std::size_t texel = texel_at(kSize, 4, box_v + j, box_u + i);
          const double truth = 2 * reference::solid_angle(reference::clipped(
                                       quadrilateral, reference::texel_outline(texel, kSize)));
          ASSERT_NEAR(energy[4 * texel + 1], truth, weight_bound(kSize, 2) * h * h);
          energy[4 * texel + 1] = 0;
        }
      }
      for (const float left : energy) ASSERT_EQ(left, 0);  // nothing outside the box
    }
  });
}

TEST(LightRotationKernel, ProjectsCornersAsTheCubeMapDoesOnEveryTarget) {
  constexpr int kSize = 64;
  constexpr std::size_t kCount = 5 * kOverlapLanes;
  AlignedVector<float> u(kCount), v(kCount);
  AlignedVector<std::int32_t> face(kCount);
  for_each_target([&] {
    Random random(43);
    std::array<int, cube::kFaces> met{};
    for (int trial = 0; trial < 200; ++trial) {
      const auto coordinate = [&] { return static_cast<float>(random.uniform(-1, 1)); };
      const CornerRow row = {{coordinate(), coordinate(), coordinate()},
                             Vec3f{coordinate(), coordinate(), coordinate()} * (2.0f / kSize)};
      project_corners(row, kSize, u, v, face);
      for (std::size_t i = 0; i < kCount; ++i) {
        const Vec3d direction = Vec3d(row.origin) + Vec3d(row.step) * static_cast<double>(i);
        if (length(direction) < 0.1) continue;  // no texel corner is so near the cube's middle
        const Vec3d met_at = cube::direction({face[i], 2.0 * static_cast<double>(u[i]) / kSize - 1,
                                              2.0 * static_cast<double>(v[i]) / kSize - 1});
        ASSERT_LE(angle_between(met_at, direction), 1e-5);
        ++met[static_cast<std::size_t>(face[i])];
      }
    }
    for (const int times : met) EXPECT_GT(times, 0);
  });
}

}  // namespace
}  // namespace rimlight
