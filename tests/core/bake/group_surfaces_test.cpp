#include "core/bake/group_surfaces.h"

#include <gtest/gtest.h>

#include <bit>
#include <numeric>
#include <set>

#include "core/base/check.h"
#include "tests/core/bake/random_samples.h"

namespace rimlight {
namespace {

Vec3f vector_at(const LaneVectors& vectors, std::size_t lane) {
  return {vectors[0][lane], vectors[1][lane], vectors[2][lane]};
}

/// The place in the hit table of the hit whose rays start here; size() when it is not there.
std::size_t place_of(const HitTable& hits, const Vec3f& origin) {
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Vec3f at{hits.component(HitTable::kOrigin)[i], hits.component(HitTable::kOrigin + 1)[i],
                   hits.component(HitTable::kOrigin + 2)[i]};
    if (at == origin) return i;
  }
  return hits.size();
}

TEST(GroupSurfaces, HoldWhatEachPixelsSurfacesAre) {
  const GroupSamples samples = test::random_samples({.edges = true, .lobes = true}, 1);
  GroupSurfaces surfaces;
  surfaces.assign(samples);
  PixelSurfaces found;
  std::size_t count = 0, lobes = 0;
  for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
    find_surfaces(samples, lane, found);
    for (std::size_t i = 0; i < kMostSurfaces; ++i) {
      const bool expected = i < found.size();
      ASSERT_EQ(i < surfaces.layer_count() && (surfaces.layer(i).lanes & lane_bit(lane)) != 0,
                expected);
      if (!expected) continue;
      ++count;
      const SurfaceLayer& layer = surfaces.layer(i);
      const PixelSurface& surface = found[i];
      const auto first = static_cast<std::size_t>(layer.first_hit[lane]);
      ASSERT_EQ(static_cast<std::size_t>(layer.hit_count[lane]), surface.hits.size());
      for (std::size_t hit = 0; hit < surface.hits.size(); ++hit) {
        const SurfaceHit& one = *surface.hits[hit];
        const Vec3f origin = RayScene::ray_origin(one, one.geometric_normal);
        ASSERT_EQ(place_of(surfaces.hits(), origin), first + hit);
        const auto value = [&](std::size_t component) {
          return surfaces.hits().component(component)[first + hit];
        };
        EXPECT_EQ(value(HitTable::kOffset), one.offset);
        EXPECT_EQ(value(HitTable::kGeometricNormal + 1), one.geometric_normal.y);
        EXPECT_EQ(value(HitTable::kShadingNormal + 2), one.shading_normal.z);
      }
      const bool is_lobe = surface.brdf.model != BrdfModel::lambert;
      ASSERT_EQ((layer.lobe_lanes & lane_bit(lane)) != 0, is_lobe);
      const Vec3f scaled = surface.brdf.albedo * (surface.share / 3.14159265f);
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(layer.lambert[static_cast<std::size_t>(c)][lane], is_lobe ? 0 : scaled[c],
                    1e-7);
      }
      if (!is_lobe) continue;
      ++lobes;
      const LobeSurface& lobe = surfaces.lobe(i, lane);
      EXPECT_EQ(lobe.brdf.model, surface.brdf.model);
      EXPECT_EQ(lobe.share, surface.share);
    }
  }
  EXPECT_GT(count, 70u);
  EXPECT_GT(lobes, 20u);
  const auto pixels = static_cast<float>(std::popcount(surfaces.layer(0).lanes));
  EXPECT_FLOAT_EQ(surfaces.surfaces_per_pixel(), static_cast<float>(count) / pixels);
}

TEST(GroupSurfaces, RespondersAreFourHitsSpreadOverTheSurface) {
  const GroupSamples samples = test::random_samples({.rays = 8}, 2);
  GroupSurfaces surfaces;
  surfaces.assign(samples);
  ASSERT_EQ(surfaces.layer_count(), 1u);
  for (std::size_t q = 0; q < kQuarters; ++q) {
    const SurfaceHit& hit = *samples.hit(0, static_cast<int>(2 * q + 1));
    EXPECT_EQ(vector_at(surfaces.layer(0).shading_normal[q], 0), hit.shading_normal);
    EXPECT_EQ(vector_at(surfaces.layer(0).geometric_normal[q], 0), hit.geometric_normal);
  }
}

TEST(GroupSurfaces, WalksVisitEveryHit) {
  std::set<std::int32_t> hit_counts;
  for (int rays = 1; rays <= 70; ++rays) {
    GroupSurfaces surfaces;
    surfaces.assign(test::random_samples({.rays = rays, .edges = true}, 3));
    for (std::size_t i = 0; i < surfaces.layer_count(); ++i) {
      const SurfaceLayer& layer = surfaces.layer(i);
      for_each_lane(layer.lanes, [&](std::size_t lane) {
        const std::int32_t hits = layer.hit_count[lane];
        hit_counts.insert(hits);
        EXPECT_TRUE(hits == 1 || std::gcd(layer.hit_step[lane], hits) == 1) << hits;
        EXPECT_LT(layer.hit_step[lane], hits);
      });
    }
  }
  EXPECT_GT(hit_counts.size(), 40u);
}

TEST(GroupSurfaces, NothingOfTheGroupBeforeStays) {
  const GroupSamples samples = test::random_samples({.rays = 4}, 4);
  GroupSurfaces fresh, used;
  used.assign(test::random_samples({.rays = 32, .edges = true, .lobes = true}, 5));
  ASSERT_GT(used.layer_count(), 1u);
  fresh.assign(samples);
  used.assign(samples);
  EXPECT_EQ(used.layer_count(), fresh.layer_count());
  EXPECT_EQ(used.layer(0).lobe_lanes, 0u);
  EXPECT_EQ(used.hits().size(), fresh.hits().size());
  EXPECT_EQ(used.layer(0).lanes, fresh.layer(0).lanes);
  EXPECT_EQ(used.layer(0).first_hit.lane, fresh.layer(0).first_hit.lane);
  EXPECT_EQ(used.layer(0).hit_count.lane, fresh.layer(0).hit_count.lane);
  EXPECT_EQ(used.layer(0).lambert[1].lane, fresh.layer(0).lambert[1].lane);
}

TEST(GroupSurfaces, OfAnEmptyGroupAreNone) {
  GroupSamples samples;
  samples.rays = 2;
  samples.hits.assign(2 * kGroupLanes, std::nullopt);
  samples.outgoing.assign(2 * kGroupLanes, Vec3f{});
  GroupSurfaces surfaces;
  surfaces.assign(samples);
  EXPECT_EQ(surfaces.layer_count(), 0u);
  EXPECT_EQ(surfaces.surfaces_per_pixel(), 0);
}

TEST(HitTable, MoreHitsThanReservedAreABug) {
  HitTable hits;
  hits.reserve(2);
  for (int i = 0; i < 2; ++i) hits.add({});
  EXPECT_THROW(
      {
        for (int i = 0; i < 100; ++i) hits.add({});
      },
      CheckFailure);
  EXPECT_THROW(hits.reserve(3), CheckFailure);
}

}  // namespace
}  // namespace rimlight
