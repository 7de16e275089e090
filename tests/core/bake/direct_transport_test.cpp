#include "core/bake/direct_transport.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/bake/lambert_kernel.h"
#include "core/bake/lobe_response.h"
#include "core/bake/sky_visibility.h"
#include "core/base/check.h"
#include "tests/core/bake/bake_scenes.h"
#include "tests/core/bake/random_samples.h"
#include "tests/support/allocation_count.h"

namespace rimlight {
namespace {

constexpr int kSize = 8;

class DirectTransportTest : public testing::Test {
 protected:
  GroupRows direct(const GroupSamples& samples, std::uint64_t seed) const {
    GroupRows rows(kSize);
    direct_.add(samples, seed, rows);
    return rows;
  }

  RayScene scene_{corner_scene(lambert(0.5f))};
  DirectTransport direct_{scene_, kSize};
};

/// share · ∫ f cos⁺ dω of one surface for a texel, in double; lobes by their own tested response.
Vec3d response(const GroupSurfaces& surfaces, std::size_t i, std::size_t lane,
               const Quarters& quarters) {
  const SurfaceLayer& layer = surfaces.layer(i);
  if ((layer.lobe_lanes & lane_bit(lane)) != 0) {
    return Vec3d(lobe_response(surfaces.lobe(i, lane), quarters));
  }
  double integral = 0;
  for (std::size_t q = 0; q < kQuarters; ++q) {
    const Vec3d direction(quarters[q].direction);
    const auto height = [&](const LaneVectors& normal) {
      return dot(Vec3d(normal[0][lane], normal[1][lane], normal[2][lane]), direction);
    };
    if (height(layer.geometric_normal[q]) <= 0) continue;
    integral += std::max(0.0, height(layer.shading_normal[q])) *
                static_cast<double>(quarters[q].solid_angle);
  }
  return Vec3d(layer.lambert[0][lane], layer.lambert[1][lane], layer.lambert[2][lane]) * integral;
}

TEST_F(DirectTransportTest, IsResponseTimesVisibilitySummedOverSurfaces) {
  const GroupSamples samples = test::random_samples({.rays = 8, .edges = true, .lobes = true}, 1);
  const GroupRows rows = direct(samples, 2);
  const TexelQuadrature texels(kSize);
  GroupSurfaces surfaces;
  surfaces.assign(samples);
  const auto visibility = std::make_unique<SkyVisibility>();
  visibility->clear(surfaces.layer_count(), texels);
  for (std::size_t i = 0; i < surfaces.layer_count(); ++i) {
    for (std::size_t texel = 0; texel < texels.count(); ++texel) {
      const Quarters& quarters = texels.quarters(texel);
      const LaneSet facing = facing_lanes(surfaces.layer(i), quarters);
      visibility->responding(i, texel) = responding_lanes(surfaces, i, quarters, facing);
    }
  }
  visibility->trace(scene_, surfaces, texels, mix_bits(2));
  int positive = 0;
  for (std::size_t texel = 0; texel < texels.count(); ++texel) {
    for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
      Vec3d expected;
      for (std::size_t i = 0; i < surfaces.layer_count(); ++i) {
        expected += response(surfaces, i, lane, texels.quarters(texel)) *
                    static_cast<double>(visibility->visibility(i, texel, lane));
      }
      for (std::size_t c = 0; c < 3; ++c) {
        const float got = rows.row(texel)[c * kGroupLanes + lane];
        ASSERT_NEAR(got, expected[static_cast<int>(c)], 1e-6) << texel << " " << lane;
        positive += got > 0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(positive, 10'000);
}

TEST_F(DirectTransportTest, AddsToWhatTheRowsHold) {
  const GroupSamples samples = test::random_samples({.rays = 4, .lobes = true}, 3);
  const GroupRows once = direct(samples, 4);
  GroupRows rows(kSize);
  std::fill(rows.values.begin(), rows.values.end(), 0.5f);
  direct_.add(samples, 4, rows);
  for (std::size_t i = 0; i < rows.values.size(); ++i) {
    ASSERT_NEAR(rows.values[i], 0.5f + once.values[i], 1e-7);
  }
}

TEST_F(DirectTransportTest, DependsOnSamplesAndSeedAlone) {
  const GroupSamples samples = test::random_samples({.rays = 4, .lobes = true}, 5);
  const GroupRows first = direct(samples, 6);
  EXPECT_NE(first.values, direct(samples, 7).values);
  // Other work on the same thread in between, also of another size.
  direct(test::random_samples({.rays = 16, .edges = true, .lobes = true}, 8), 9);
  const DirectTransport larger(scene_, 2 * kSize);
  GroupRows larger_rows(2 * kSize);
  larger.add(samples, 6, larger_rows);
  EXPECT_EQ(first.values, direct(samples, 6).values);
}

TEST_F(DirectTransportTest, OfPixelsThatSeeNothingIsNothing) {
  GroupSamples samples = test::random_samples({.rays = 2}, 10);
  std::fill(samples.hits.begin(), samples.hits.end(), std::nullopt);
  const GroupRows rows = direct(samples, 11);
  EXPECT_EQ(rows.values, GroupRows(kSize).values);
}

TEST_F(DirectTransportTest, StopsAllocatingAfterTheFirstGroups) {
  if (!test::kCountsAllocations) GTEST_SKIP() << "allocations are not counted in this build";
  std::vector<GroupSamples> groups;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    groups.push_back(
        test::random_samples({.rays = 8, .edges = seed % 2 == 0, .lobes = seed > 1}, seed));
  }
  GroupRows rows(kSize);
  std::size_t counts[2] = {};
  for (std::size_t& count : counts) {
    const std::size_t before = test::allocation_count();
    for (const GroupSamples& samples : groups) direct_.add(samples, 12, rows);
    count = test::allocation_count() - before;
  }
  EXPECT_EQ(counts[1], 0u);
}

TEST_F(DirectTransportTest, RowsOfAnotherSizeAreABug) {
  GroupRows rows(2 * kSize);
  EXPECT_THROW(direct_.add(test::random_samples({}, 13), 14, rows), CheckFailure);
}

}  // namespace
}  // namespace rimlight
