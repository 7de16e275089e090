// The smooth factor of direct transport: responses of Lambert surfaces and of lobes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/bake/lambert_kernel.h"
#include "core/bake/lobe_response.h"
#include "tests/core/bake/random_samples.h"
#include "tests/support/every_target.h"
#include "tests/support/reference/brdf.h"

namespace rimlight {
namespace {

constexpr int kSize = 8;

Vec3d vector_at(const LaneVectors& vectors, std::size_t lane) {
  return {vectors[0][lane], vectors[1][lane], vectors[2][lane]};
}

/// ∫ cos⁺θ dω by the kernel's four points, in double. `least`: how near any point is to a horizon.
struct CosineIntegral {
  double value = 0, least = 1;
};
CosineIntegral cosine_integral(const SurfaceLayer& layer, std::size_t lane,
                               const Quarters& quarters) {
  CosineIntegral result;
  for (std::size_t q = 0; q < kQuarters; ++q) {
    const Vec3d direction(quarters[q].direction);
    const double cosine = dot(vector_at(layer.shading_normal[q], lane), direction);
    const double height = dot(vector_at(layer.geometric_normal[q], lane), direction);
    if (height > 0)
      result.value += std::max(cosine, 0.0) * static_cast<double>(quarters[q].solid_angle);
    result.least = std::min({result.least, std::abs(cosine), std::abs(height)});
  }
  return result;
}

TEST(LambertKernel, FacingLanesAndAddedLightAreThoseOfADoubleLoop) {
  GroupSurfaces surfaces;
  surfaces.assign(test::random_samples({.edges = true, .lobes = true}, 1));
  const TexelQuadrature texels(kSize);
  ASSERT_GT(surfaces.layer_count(), 1u);
  Random random(3);
  const int targets = test::for_every_target([&] {
    int facing_count = 0, away_count = 0;
    for (std::size_t texel = 0; texel < texels.count(); ++texel) {
      const std::size_t i = texel % surfaces.layer_count();
      const SurfaceLayer& layer = surfaces.layer(i);
      const Quarters& quarters = texels.quarters(texel);
      const LaneSet facing = facing_lanes(layer, quarters);
      AlignedVector<std::uint8_t> lit(kGroupLanes);
      for (std::uint8_t& count : lit) count = static_cast<std::uint8_t>(random.below(6));
      if (random.below(3) == 0) std::fill(lit.begin(), lit.begin() + 32, std::uint8_t{0});
      const LaneSet refined = random.bits();
      AlignedVector<float> row(kRowLanes, 0.25f);
      add_lambert(layer, {quarters, lit.data(), refined, 0.2f}, row.data());
      for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
        const CosineIntegral expected = cosine_integral(layer, lane, quarters);
        const bool faces = (facing & lane_bit(lane)) != 0;
        if ((layer.lanes & lane_bit(lane)) == 0) {
          EXPECT_FALSE(faces);
        } else if (expected.least > 1e-6) {
          EXPECT_EQ(faces, expected.value > 0);
        }
        ++(faces ? facing_count : away_count);
        const double visibility = lit[lane] * ((refined & lane_bit(lane)) != 0 ? 0.2 : 1.0);
        for (std::size_t c = 0; c < 3; ++c) {
          const double value =
              static_cast<double>(layer.lambert[c][lane]) * expected.value * visibility;
          // Rounding of cosines of about 1 times the solid angle, visibility up to 5.
          ASSERT_NEAR(row[c * kGroupLanes + lane], 0.25 + value, 5e-7);
        }
      }
    }
    EXPECT_GT(facing_count, 3000);
    EXPECT_GT(away_count, 3000);
  });
  EXPECT_GE(targets, 2);
}

/// One plane with one normal, all lit: Σ over the sky of albedo / π · cos⁺θ dω is albedo · share.
TEST(LambertKernel, UnderAUniformSkyAnOpenSurfaceReflectsItsAlbedo) {
  GroupSamples samples = test::random_samples({.rays = 2}, 4);
  for (auto& hit : samples.hits) {
    if (hit) hit->shading_normal = hit->geometric_normal;
  }
  GroupSurfaces surfaces;
  surfaces.assign(samples);
  const TexelQuadrature texels(16);
  AlignedVector<float> row(kRowLanes);
  const AlignedVector<std::uint8_t> lit(kGroupLanes, 1);
  for (std::size_t texel = 0; texel < texels.count(); ++texel) {
    add_lambert(surfaces.layer(0), {texels.quarters(texel), lit.data(), 0, 0}, row.data());
  }
  PixelSurfaces found;
  int checked = 0;
  for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
    find_surfaces(samples, lane, found);
    if (found.size() == 0) continue;
    for (int c = 0; c < 3; ++c) {
      const float expected = found[0].brdf.albedo[c] * found[0].share;
      // A horizon across 64 texels of 1/16 costs less than their corners: 1 %.
      EXPECT_NEAR(row[static_cast<std::size_t>(c) * kGroupLanes + lane], expected,
                  0.005 * expected);
      ++checked;
    }
  }
  EXPECT_GT(checked, 150);
}

/// The response of a lobe by the same points, in double and from the reference's formulas.
Vec3d reference_response(const LobeSurface& lobe, const Quarters& quarters) {
  Vec3d sum;
  for (std::size_t q = 0; q < kQuarters; ++q) {
    const Vec3f& direction = quarters[q].direction;
    const Vec3f in = lobe.frame[q].to_local(direction);
    if (dot(lobe.geometric_normal[q], direction) <= 0 || in.z <= 0) continue;
    const Vec3d in_double = normalized(Vec3d(in)), out = normalized(Vec3d(lobe.outgoing[q]));
    const Vec3f diffuse = evaluate_diffuse(lobe.brdf, in, lobe.outgoing[q]);
    for (int c = 0; c < 3; ++c) {
      sum[c] +=
          (static_cast<double>(diffuse[c]) + reference::specular(lobe.brdf, c, in_double, out)) *
          in_double.z * static_cast<double>(quarters[q].solid_angle);
    }
  }
  return sum * static_cast<double>(lobe.share);
}

/// What each lobe surface of a group responds to each texel, visited one after the other.
template <typename Visit>
int for_each_lobe(const GroupSurfaces& surfaces, const Visit& visit) {
  int lobes = 0;
  for (std::size_t i = 0; i < surfaces.layer_count(); ++i) {
    for_each_lane(surfaces.layer(i).lobe_lanes, [&](std::size_t lane) {
      visit(surfaces.lobe(i, lane));
      ++lobes;
    });
  }
  return lobes;
}

TEST(LobeResponse, IsTheReferenceBrdfsQuadrature) {
  GroupSurfaces surfaces;
  surfaces.assign(test::random_samples({.edges = true, .lobes = true}, 6));
  const TexelQuadrature texels(kSize);
  int positive = 0;
  const int lobes = for_each_lobe(surfaces, [&](const LobeSurface& lobe) {
    for (std::size_t texel = 0; texel < texels.count(); ++texel) {
      const Vec3f response = lobe_response(lobe, texels.quarters(texel));
      const Vec3d expected = reference_response(lobe, texels.quarters(texel));
      for (int c = 0; c < 3; ++c) {
        ASSERT_NEAR(response[c], expected[c], 1e-3 * expected[c] + 1e-7);
        positive += response[c] > 1e-4f ? 1 : 0;
      }
    }
  });
  EXPECT_GT(lobes, 20);
  EXPECT_GT(positive, 5000);
}

TEST(LobeResponse, LanesWithoutAResponseDropOutAndLambertLanesStay) {
  GroupSurfaces surfaces;
  GroupSamples samples = test::random_samples({.rays = 4, .lobes = true}, 8);
  for (auto& hit : samples.hits) {
    if (!hit || hit->brdf.model != BrdfModel::phong) continue;
    hit->brdf.albedo = {};  // a mirror: dark off its lobe
    hit->brdf.exponent = 1e5f;
  }
  surfaces.assign(samples);
  const TexelQuadrature texels(kSize);
  const SurfaceLayer& layer = surfaces.layer(0);
  int dropped = 0, kept = 0;
  for (std::size_t texel = 0; texel < texels.count(); ++texel) {
    const Quarters& quarters = texels.quarters(texel);
    const LaneSet facing = facing_lanes(layer, quarters);
    const LaneSet responding = responding_lanes(surfaces, 0, quarters, facing);
    EXPECT_EQ(responding & ~layer.lobe_lanes, facing & ~layer.lobe_lanes);
    for_each_lane(facing & layer.lobe_lanes, [&](std::size_t lane) {
      const bool expected = max_component(lobe_response(surfaces.lobe(0, lane), quarters)) > 0;
      EXPECT_EQ((responding & lane_bit(lane)) != 0, expected);
      ++(expected ? kept : dropped);
    });
  }
  EXPECT_GT(dropped, 100);
  EXPECT_GT(kept, 100);
}

}  // namespace
}  // namespace rimlight
