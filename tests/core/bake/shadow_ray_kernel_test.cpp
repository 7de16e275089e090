#include "core/bake/shadow_ray_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <vector>

#include "core/base/check.h"
#include "core/math/sampling.h"
#include "tests/core/bake/random_samples.h"
#include "tests/support/every_target.h"
#include "tests/support/statistics.h"

namespace rimlight {
namespace {

constexpr int kSize = 8;
constexpr std::uint64_t kSeed = 0xfedcba9876543210;

/// pcg3d straight from the paper, one number at a time.
std::array<std::uint32_t, 3> pcg3d(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  std::array<std::uint32_t, 3> v = {x, y, z};
  for (std::uint32_t& one : v) one = one * 1664525u + 1013904223u;
  for (int round = 0; round < 2; ++round) {
    v[0] += v[1] * v[2];
    v[1] += v[2] * v[0];
    v[2] += v[0] * v[1];
    if (round == 0) {
      for (std::uint32_t& one : v) one ^= one >> 16;
    }
  }
  return v;
}

/// Where a surface's ray k to a texel begins and goes, in double.
struct ExpectedRay {
  std::size_t hit = 0;  // in the hit table
  Sample2 at;           // in the texel
};
struct SurfaceName {
  std::size_t layer, lane;
};
ExpectedRay expected_ray(const GroupSurfaces& surfaces, const SurfaceName& name, std::size_t texel,
                         int k, std::uint64_t seed = kSeed) {
  const auto [i, lane] = name;
  const SurfaceLayer& layer = surfaces.layer(i);
  const auto bits = pcg3d(static_cast<std::uint32_t>(texel) + static_cast<std::uint32_t>(seed),
                          static_cast<std::uint32_t>(i * kGroupLanes + lane),
                          static_cast<std::uint32_t>(seed >> 32));
  ExpectedRay ray;
  ray.at = r2_point({bits[0] * 0x1p-32, bits[1] * 0x1p-32}, k);
  const auto count = static_cast<std::size_t>(layer.hit_count[lane]);
  const auto begin =
      static_cast<std::size_t>((bits[2] >> 8) * 0x1p-24 * static_cast<double>(count));
  const auto step = static_cast<std::size_t>(layer.hit_step[lane]) * static_cast<std::size_t>(k);
  ray.hit = static_cast<std::size_t>(layer.first_hit[lane]) + (begin + step) % count;
  return ray;
}

Vec3d vector_of(const HitTable& hits, std::size_t component, std::size_t hit) {
  return {hits.component(component)[hit], hits.component(component + 1)[hit],
          hits.component(component + 2)[hit]};
}

struct Traced {
  Vec3d origin, direction;
  std::uint32_t slot = 0;
};
Traced ray_at(const ShadowRays& rays, std::size_t i) {
  const auto& o = rays.rays.origin;
  const auto& d = rays.rays.direction;
  return {{o[0][i], o[1][i], o[2][i]}, {d[0][i], d[1][i], d[2][i]}, rays.slot[i]};
}

/// Surfaces on planes of all slopes, and the texels of a small cube.
class ShadowRayKernel : public testing::Test {
 protected:
  ShadowRayKernel() { surfaces_.assign(test::random_samples({.edges = true}, 1)); }

  ShadowRayRequest request(std::size_t layer, std::size_t texel, LaneSet lanes, int first,
                           int count) const {
    return {surfaces_,
            layer,
            texels_.patch(texel),
            lanes,
            first,
            count,
            static_cast<std::uint32_t>(texel * kGroupLanes),
            kSeed};
  }

  /// What is wrong with a ray that ought to be the expected one.
  void compare(const Traced& ray, const ExpectedRay& expected, std::size_t texel) {
    const HitTable& hits = surfaces_.hits();
    const Vec3d geometric = vector_of(hits, HitTable::kGeometricNormal, expected.hit);
    const Vec3d shading = vector_of(hits, HitTable::kShadingNormal, expected.hit);
    const TexelPatch patch = texels_.patch(texel);
    const Vec3d inside =
        Vec3d(patch.corner) + Vec3d(patch.across) * expected.at.u + Vec3d(patch.up) * expected.at.v;
    const double height = std::min(dot(geometric, inside), dot(shading, inside));
    if (std::abs(height) < 1e-5) return;
    Vec3d direction = inside;
    if (height < 0) {
      ++straddling_;
      const Quarters& quarters = texels_.quarters(texel);
      direction = Vec3d(
          std::max_element(quarters.begin(), quarters.end(), [&](const auto& a, const auto& b) {
            return dot(shading, Vec3d(a.direction)) < dot(shading, Vec3d(b.direction));
          })->direction);
    } else {
      ++above_;
    }
    ASSERT_LT(length(ray.direction - direction), 2e-6);
    const double offset = static_cast<double>(hits.component(HitTable::kOffset)[expected.hit]);
    const double side = dot(geometric, direction) < 0 ? -offset : offset;
    const Vec3d origin =
        vector_of(hits, HitTable::kOrigin, expected.hit) + geometric * (side - offset);
    ASSERT_LT(length(ray.origin - origin), 1e-6);
  }

  GroupSurfaces surfaces_;
  TexelQuadrature texels_{kSize};
  std::unique_ptr<ShadowRays> rays_ = std::make_unique<ShadowRays>();
  int above_ = 0, straddling_ = 0;
};

TEST_F(ShadowRayKernel, EveryTargetGivesTheRaysOfTheDefinitionInDouble) {
  ASSERT_GT(surfaces_.layer_count(), 1u);
  Random random(3);
  const int targets = test::for_every_target([&] {
    for (std::size_t texel = 0; texel < texels_.count(); ++texel) {
      const std::size_t layer = random.below(surfaces_.layer_count());
      const LaneSet lanes = surfaces_.layer(layer).lanes & (random.bits() | random.bits());
      const bool more = random.below(2) == 1;
      const int first = more ? 1 : 0, count = more ? 4 : 1;
      rays_->rays.count = random.below(100);  // not always at the begin of a vector
      std::size_t i = rays_->rays.count;
      add_shadow_rays(request(layer, texel, lanes, first, count), *rays_);
      for_each_lane(lanes, [&](std::size_t lane) {
        for (int k = first; k < first + count; ++k, ++i) {
          const Traced ray = ray_at(*rays_, i);
          ASSERT_EQ(ray.slot, texel * kGroupLanes + lane);
          compare(ray, expected_ray(surfaces_, {layer, lane}, texel, k), texel);
        }
      });
      ASSERT_EQ(rays_->rays.count, i);
    }
  });
  EXPECT_GE(targets, 2);
  EXPECT_GT(above_, 5000);
  EXPECT_GT(straddling_, 1000);
}

TEST_F(ShadowRayKernel, RaysStayWithinTheirTexelAndStartOnTheirOwnSurface) {
  for (std::size_t texel = 0; texel < texels_.count(); ++texel) {
    rays_->rays.count = 0;
    const SurfaceLayer& layer = surfaces_.layer(0);
    add_shadow_rays(request(0, texel, layer.lanes, 0, 8), *rays_);
    for (std::size_t i = 0; i < rays_->rays.count; ++i) {
      const Traced ray = ray_at(*rays_, i);
      const std::size_t lane = ray.slot % kGroupLanes;
      // Inside, but for a rounding error at the border: a little towards the middle is inside.
      const Vec3d middle = cube::texel_direction(texel, kSize);
      EXPECT_EQ(cube::texel_of(normalized(ray.direction) + middle * 1e-5, kSize), texel);
      const auto first = static_cast<std::size_t>(layer.first_hit[lane]);
      double nearest = 1;
      for (std::size_t hit = first; hit < first + static_cast<std::size_t>(layer.hit_count[lane]);
           ++hit) {
        const Vec3d normal = vector_of(surfaces_.hits(), HitTable::kGeometricNormal, hit);
        const Vec3d position = vector_of(surfaces_.hits(), HitTable::kOrigin, hit) - normal * 1e-4;
        nearest = std::min(nearest, length(ray.origin - position));
      }
      EXPECT_NEAR(nearest, 1e-4, 1e-6);  // the samples' offset
    }
  }
}

TEST_F(ShadowRayKernel, FewRaysLieApartInTheTexelAndVisitDifferentHits) {
  const SurfaceLayer& layer = surfaces_.layer(0);
  int surfaces = 0;
  for_each_lane(layer.lanes, [&](std::size_t lane) {
    rays_->rays.count = 0;
    // The texel above the surface, where no ray falls below the horizon.
    const Vec3f normal{layer.shading_normal[0][0][lane], layer.shading_normal[0][1][lane],
                       layer.shading_normal[0][2][lane]};
    const std::size_t texel = cube::texel_of(Vec3d(normal), kSize);
    add_shadow_rays(request(0, texel, lane_bit(lane), 0, 16), *rays_);
    ASSERT_EQ(rays_->rays.count, 16u);
    ++surfaces;
    const double side = 2.0 / kSize;
    std::set<double> origins;
    for (std::size_t i = 0; i < 16; ++i) {
      origins.insert(ray_at(*rays_, i).origin.x);
      for (std::size_t j = 0; j < i && i < 5; ++j) {
        const Vec3d between = ray_at(*rays_, i).direction - ray_at(*rays_, j).direction;
        EXPECT_GT(length(between), 0.2 * side) << i << " " << j;
      }
    }
    EXPECT_EQ(origins.size(), std::min(16u, static_cast<unsigned>(layer.hit_count[lane])));
  });
  EXPECT_GT(surfaces, 40);
}

/// Chances below 1e-8 for each score, of which there are 8.
TEST_F(ShadowRayKernel, RandomBeginsCoverTexelAndHitsEvenlyAndDoNotFollowTheirNeighbours) {
  constexpr int kRays = 16;
  GroupSamples samples = test::random_samples({.rays = kRays}, 4);
  test::Histogram u_bins(128), v_bins(128), square(256), hit_bins(kRays);
  test::Mean u_by_texel, u_by_lane, u_by_v, u_by_hit;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    surfaces_.assign(samples);
    const SurfaceLayer& layer = surfaces_.layer(0);
    std::vector<ExpectedRay> before(kGroupLanes);
    for (std::size_t texel = 0; texel < texels_.count(); ++texel) {
      ExpectedRay last;
      for_each_lane(layer.lanes, [&](std::size_t lane) {
        if (layer.hit_count[lane] != kRays) return;
        const ExpectedRay ray = expected_ray(surfaces_, {0, lane}, texel, 0, mix_bits(seed));
        const auto [u, v] = ray.at;
        const double hit =
            (static_cast<double>(ray.hit) - static_cast<double>(layer.first_hit[lane]) + 0.5) /
            kRays;
        u_bins.add(u);
        v_bins.add(v);
        square.add((std::floor(u * 16) + v) / 16);
        hit_bins.add(hit);
        u_by_v.add((u - 0.5) * (v - 0.5));
        u_by_hit.add((u - 0.5) * (hit - 0.5));
        u_by_lane.add((u - 0.5) * (last.at.u - 0.5));
        if (texel > 0) u_by_texel.add((u - 0.5) * (before[lane].at.u - 0.5));
        before[lane] = last = ray;
      });
    }
  }
  for (const test::Histogram& bins : {u_bins, v_bins, square, hit_bins}) {
    EXPECT_LT(std::abs(bins.score()), 6);
  }
  for (const test::Mean& product : {u_by_texel, u_by_lane, u_by_v, u_by_hit}) {
    EXPECT_LT(std::abs(product.score(0)), 6);
  }
}

TEST_F(ShadowRayKernel, RequestsThatDoNotFitAreBugs) {
  const auto add = [this](int first, int count, std::uint32_t slot, std::size_t already) {
    rays_->rays.count = already;
    ShadowRayRequest wrong = request(0, 0, 1, first, count);
    wrong.first_slot = slot;
    add_shadow_rays(wrong, *rays_);
  };
  EXPECT_NO_THROW(add(0, 4, 64, SkyRays::kCapacity - 4 * kGroupLanes));
  EXPECT_THROW(add(0, 4, 64, SkyRays::kCapacity - 4 * kGroupLanes + 1), CheckFailure);
  EXPECT_THROW(add(0, 3, 64, 0), CheckFailure);
  EXPECT_THROW(add(0, 1, 65, 0), CheckFailure);
  EXPECT_THROW(add(-1, 1, 64, 0), CheckFailure);
}

}  // namespace
}  // namespace rimlight
