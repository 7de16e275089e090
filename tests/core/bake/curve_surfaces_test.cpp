// What surfaces of editable materials reflect, found again from their points and their sky, against
// the direct transport that is traced for the same materials.
#include "core/bake/curve_surfaces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "core/bake/direct_transport.h"
#include "core/base/parallel.h"
#include "core/math/random.h"
#include "tests/core/bake/bake_scenes.h"
#include "tests/core/bake/curve_scenes.h"
#include "tests/support/error_of.h"

namespace rimlight {
namespace {

using test::error_of;
using ::testing::HasSubstr;

CurveSurfaces find(const RayScene& scene, const EditableMaterials& editable,
                   const std::vector<CubeLight>& lights = {}) {
  return find_curve_surfaces(scene, editable, lights, [](double) {});
}

/// What one surface reflects of a texel of radiance 1: share · ∫ f cos⁺ dω · fifths / 5.
Vec3d reflected(const CurveSurface& surface, const CurveMaterial& material,
                const Quarters& quarters, std::uint8_t fifths) {
  Brdf brdf = material.brdf;
  brdf.albedo = brdf.albedo * surface.tint;
  Vec3d sum;
  for (std::size_t q = 0; q < kQuarters; ++q) {
    const SurfacePoint& point = surface.points[q];
    const Vec3f& direction = quarters[q].direction;
    const double cosine = dot(Vec3d(point.normal), Vec3d(direction));
    if (cosine <= 0 || dot(Vec3d(point.geometric_normal), Vec3d(direction)) <= 0) continue;
    const Frame<float> frame(point.normal, point.tangent);
    const Vec3f in = frame.to_local(direction), out = frame.to_local(point.outgoing);
    const Vec3d value = material.measured ? evaluate(*material.measured, Vec3d(in), Vec3d(out))
                                          : Vec3d(evaluate(brdf, in, out));
    sum += value * (cosine * static_cast<double>(quarters[q].solid_angle));
  }
  return sum * (static_cast<double>(surface.share) * fifths / 5);
}

/// The same of all surfaces: [texel][channel][receiver], of a picture of one tile.
std::vector<double> rows_of(const CurveSurfaces& found, const EditableMaterials& editable,
                            int cube_size) {
  const TexelQuadrature texels(cube_size);
  std::vector<double> rows(texels.count() * 3 * kTileReceivers);
  std::vector<std::uint8_t> fifths(texels.count());
  for (std::size_t i = 0; i < found.surfaces.size(); ++i) {
    const CurveSurface& surface = found.surfaces[i];
    found.visibility.view().unpack(i, fifths);
    for (std::size_t texel = 0; texel < texels.count(); ++texel) {
      const Vec3d value = reflected(surface, editable.materials[surface.material],
                                    texels.quarters(texel), fifths[texel]);
      for (std::size_t c = 0; c < 3; ++c) {
        rows[(texel * 3 + c) * kTileReceivers + surface.receiver] += value[static_cast<int>(c)];
      }
    }
  }
  return rows;
}

/// What DirectTransport traces, of the same shape.
std::vector<double> traced_rows(const RayScene& scene, const MaterialSet& materials) {
  const BakeSettings& bake = scene.scene().bake;
  const PixelLayout layout{bake.width, bake.height};
  const DirectTransport direct(scene, bake.cube_size, materials);
  const std::size_t texels = cube::texel_count(bake.cube_size);
  std::vector<double> rows(texels * 3 * kTileReceivers);
  for (std::size_t first = 0; first < kTileReceivers; first += kGroupLanes) {
    GroupSamples samples;
    sample_group(scene, layout, first, bake.primary_rays, bake.seed, samples);
    GroupRows group(bake.cube_size);
    direct.add(samples, mix_bits(bake.seed ^ mix_bits(first)), group);
    for (std::size_t row = 0; row < 3 * texels; ++row) {
      for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
        rows[row * kTileReceivers + first + lane] = group.values[row * kGroupLanes + lane];
      }
    }
  }
  return rows;
}

double sum_of(const std::vector<double>& rows) {
  double sum = 0;
  for (const double value : rows) sum += value;
  return sum;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

TEST(CurveSurfaces, ReflectWhatTheDirectTransportOfTheirMaterialsDoes) {
  // Pearl alone responds to each texel that it faces, so that both cast the same rays. So does the
  // floor, a Lambert one.
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"pearl"}, {"floor"}, {"cloth"}, {"pearl", "floor", "cloth"}}) {
    auto scene = test::curve_scene();
    scene->bake.editable = names;
    const RayScene rays(scene);
    const EditableMaterials editable = find_editable_materials(*scene);
    const CurveSurfaces found = find(rays, editable);
    EXPECT_GT(found.surfaces.size(), 40u);
    const std::vector<double> expected = traced_rows(rays, editable.set());
    const std::vector<double> rows = rows_of(found, editable, scene->bake.cube_size);
    const double largest = *std::ranges::max_element(expected);
    ASSERT_GT(largest, 1e-3);
    EXPECT_LT(largest_difference(rows, expected), 1e-5 * largest) << names.size();
  }
}

TEST(CurveSurfaces, OfAMetalDifferByTheNoiseOfRaysAlone) {
  auto scene = test::curve_scene();
  scene->bake.editable = {"gold"};
  const RayScene rays(scene);
  const EditableMaterials editable = find_editable_materials(*scene);
  const std::vector<double> rows = rows_of(find(rays, editable), editable, scene->bake.cube_size);
  const std::vector<double> expected = traced_rows(rays, editable.set());
  EXPECT_GT(sum_of(expected), 1);
  EXPECT_NEAR(sum_of(rows) / sum_of(expected), 1, 0.01);
}

TEST(CurveSurfaces, WithTheTransportOfTheOthersAreAllLight) {
  auto scene = test::curve_scene();
  scene->bake.editable = {"pearl", "gold"};
  const RayScene rays(scene);
  const EditableMaterials editable = find_editable_materials(*scene);
  const double with = sum_of(rows_of(find(rays, editable), editable, scene->bake.cube_size));
  const double without = sum_of(traced_rows(rays, editable.set().others()));
  const double all = sum_of(traced_rows(rays, {}));
  EXPECT_GT(with, 0.1 * all);
  EXPECT_GT(without, 0.1 * all);
  EXPECT_NEAR((with + without) / all, 1, 0.005);
  // Of one material there are no rays that others decide about: the same to a rounding.
  auto box = convex_scene(metal(0.5f));
  box->materials.push_back(lambert(0.5f));
  box->meshes.push_back(quad({-0.9f, -0.9f, 0.9f}, {0.5f, 0, 0}, {0, 0.5f, 0}, 1));
  box->bake.cube_size = 8;
  box->bake.primary_rays = 4;
  const RayScene box_rays(box);
  const EditableMaterials metal_alone = find_editable_materials(*box);
  std::vector<double> sum = traced_rows(box_rays, metal_alone.set());
  const std::vector<double> others = traced_rows(box_rays, metal_alone.set().others());
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += others[i];
  const std::vector<double> both = traced_rows(box_rays, {});
  EXPECT_GT(sum_of(others), 0.01 * sum_of(both));
  EXPECT_NEAR(sum_of(sum) / sum_of(both), 1, 0.005);
}

TEST(CurveSurfaces, StandInTheOrderOfTileMaterialAndReceiver) {
  auto scene = test::curve_scene();
  scene->bake.width = 96;  // two tiles
  scene->bake.editable = {"gold", "floor"};
  const RayScene rays(scene);
  const EditableMaterials editable = find_editable_materials(*scene);
  EXPECT_EQ(editable.index,
            (std::vector{EditableMaterials::kNone, 0u, 1u, EditableMaterials::kNone}));
  const CurveSurfaces found = find(rays, editable);
  const auto order = [](const CurveSurface& s) {
    return std::tuple(s.receiver / kTileReceivers, s.material, s.receiver);
  };
  EXPECT_TRUE(std::ranges::is_sorted(found.surfaces, {}, order));
  EXPECT_EQ(found.visibility.view().surface_count(), found.surfaces.size());
  EXPECT_EQ(found.surfaces.back().receiver / kTileReceivers, 1u);
  for (const std::uint32_t material : {0u, 1u}) {
    EXPECT_GT(std::ranges::count(found.surfaces, material, &CurveSurface::material), 50);
  }
  std::vector<double> shares(2 * kTileReceivers);
  for (const CurveSurface& surface : found.surfaces) {
    EXPECT_GT(surface.share, 0);
    shares[surface.receiver] += static_cast<double>(surface.share);
  }
  EXPECT_LE(*std::ranges::max_element(shares), 1 + 1e-6);
}

TEST(CurveSurfaces, HaveTheTextureForTheirTint) {
  auto scene = test::curve_scene();
  const RayScene rays(scene);
  const EditableMaterials editable = find_editable_materials(*scene);
  const CurveSurfaces found = find(rays, editable);
  float least = 2, most = -1;
  for (const CurveSurface& surface : found.surfaces) {
    if (surface.material != 0) {  // gold and cloth: black below their gloss, and no texture
      EXPECT_EQ(surface.tint, Vec3f(1, 1, 1));
      continue;
    }
    EXPECT_NEAR(surface.tint.z, 0.5f, 1e-5);
    EXPECT_NEAR(surface.tint.x + surface.tint.y, 1, 1e-5);
    least = std::min(least, surface.tint.x);
    most = std::max(most, surface.tint.x);
  }
  EXPECT_GT(most - least, 0.5f);
}

TEST(CurveSurfaces, ImagesAreWhatTheyReflectOfEachLight) {
  auto scene = test::curve_scene();
  const RayScene rays(scene);
  const EditableMaterials editable = find_editable_materials(*scene);
  const std::vector<CubeLight> lights = {builtin_environment("sunny").project(8),
                                         builtin_environment("studio").project(8)};
  const CurveSurfaces found = find(rays, editable, lights);
  ASSERT_EQ(found.images.size(), 2u);
  const std::vector<double> rows = rows_of(found, editable, 8);
  for (std::size_t light = 0; light < 2; ++light) {
    ASSERT_EQ(found.images[light].size(), kTileReceivers);
    for (std::size_t receiver = 0; receiver < kTileReceivers; ++receiver) {
      for (std::size_t c = 0; c < 3; ++c) {
        double expected = 0;
        for (std::size_t texel = 0; texel < cube::texel_count(8); ++texel) {
          expected += rows[(texel * 3 + c) * kTileReceivers + receiver] *
                      static_cast<double>(lights[light].at(texel)[static_cast<int>(c)]);
        }
        ASSERT_NEAR(found.images[light][receiver][static_cast<int>(c)], expected,
                    1e-4 * expected + 1e-6)
            << light << " " << receiver;
      }
    }
  }
}

TEST(CurveSurfaces, AreTheSameBitsForAnyNumberOfThreads) {
  const RayScene rays(test::curve_scene());
  const EditableMaterials editable = find_editable_materials(rays.scene());
  const std::vector<CubeLight> lights = {builtin_environment("sunny").project(8)};
  set_thread_count(1);
  const CurveSurfaces one = find(rays, editable, lights);
  for (const int threads : {2, 3}) {
    set_thread_count(threads);
    const CurveSurfaces some = find(rays, editable, lights);
    ASSERT_EQ(some.surfaces.size(), one.surfaces.size());
    EXPECT_EQ(std::memcmp(some.surfaces.data(), one.surfaces.data(),
                          one.surfaces.size() * sizeof(CurveSurface)),
              0);
    EXPECT_EQ(some.images, one.images);
    EXPECT_TRUE(std::ranges::equal(some.visibility.view().blocks, one.visibility.view().blocks));
    EXPECT_TRUE(std::ranges::equal(some.visibility.view().mixed, one.visibility.view().mixed));
    EXPECT_GT(one.visibility.view().mixed.size(), 100u);
  }
  set_thread_count(0);
}

TEST(CurveSurfaces, OfWhichThePictureShowsNoneAreAnError) {
  auto scene = test::curve_scene();
  Material hidden = metal(0.3f);
  hidden.name = "hidden";
  scene->materials.push_back(hidden);
  scene->bake.editable = {"hidden"};
  const RayScene rays(scene);
  const EditableMaterials editable = find_editable_materials(*scene);
  EXPECT_THAT(error_of([&] { find(rays, editable); }),
              HasSubstr("no editable material in the picture"));
}

}  // namespace
}  // namespace rimlight
