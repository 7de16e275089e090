#include "core/bake/lane_kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/math/random.h"
#include "tests/support/every_target.h"

namespace rimlight {
namespace {

void fill(AlignedVector<float>& values, Random& random) {
  for (float& value : values) value = static_cast<float>(random.uniform(-1, 1));
}

TEST(LaneKernel, AddsWeightedLanesWithinOneRounding) {
  const int targets = test::for_every_target([] {
    Random random(5);
    AlignedVector<float> weights(kRowLanes), sum(kRowLanes);
    for (int round = 0; round < 20; ++round) {
      fill(weights, random);
      fill(sum, random);
      const AlignedVector<float> before = sum;
      const Vec3f value{static_cast<float>(random.uniform(-2, 2)), 0.0f,
                        static_cast<float>(random.uniform(-2, 2))};
      add_weighted_lanes(weights.data(), value, sum.data());
      for (std::size_t i = 0; i < kRowLanes; ++i) {
        const double product =
            static_cast<double>(weights[i]) * value[static_cast<int>(i / kGroupLanes)];
        // One rounding of the product where there is no FMA, one of the sum.
        const double bound = (std::abs(product) + std::abs(before[i])) * 0x1p-23;
        EXPECT_NEAR(sum[i], before[i] + product, bound);
      }
    }
  });
  EXPECT_GE(targets, 2);
}

TEST(LaneKernel, MultipliesRowsLikeADoubleLoop) {
  constexpr int kSize = 4;  // 96 rows: more than one block of rows, and not a multiple of it
  Random random(6);
  GroupRows rows(kSize);
  fill(rows.values, random);
  std::vector<CubeLight> lights(3, CubeLight(kSize));
  for (CubeLight& light : lights) fill(light.values, random);
  test::for_every_target([&] {
    AlignedVector<float> images(lights.size() * kRowLanes, 99.0f);
    multiply_rows(rows, lights, images.data());
    double worst = 0;
    for (std::size_t light = 0; light < lights.size(); ++light) {
      for (std::size_t i = 0; i < kRowLanes; ++i) {
        double sum = 0, magnitude = 0;
        for (std::size_t row = 0; row < cube::texel_count(kSize); ++row) {
          const double term =
              static_cast<double>(lights[light].channel(static_cast<int>(i / kGroupLanes))[row]) *
              static_cast<double>(rows.row(row)[i]);
          sum += term;
          magnitude += std::abs(term);
        }
        const double error = std::abs(images[light * kRowLanes + i] - sum) / magnitude;
        worst = std::max(worst, error);
      }
    }
    EXPECT_LT(worst, 1e-5);
    EXPECT_GT(worst, 0) << "nothing was compared";
  });
}

}  // namespace
}  // namespace rimlight
