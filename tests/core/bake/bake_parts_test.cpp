// The smaller parts of a bake: a pixel's surfaces, check lights, and what is kept to resume from.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/bake/check_lights.h"
#include "core/bake/fingerprint.h"
#include "core/bake/surface_groups.h"
#include "core/bake/tile_check.h"
#include "core/base/files.h"
#include "core/math/random.h"
#include "core/transport/receivers.h"
#include "tests/core/bake/bake_scenes.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

SurfaceHit hit_with(const Vec3f& normal, float albedo) {
  SurfaceHit hit;
  hit.geometric_normal = hit.shading_normal = normalized(normal);
  hit.brdf.albedo = {albedo, albedo, albedo};
  return hit;
}

GroupSamples one_pixel(const std::vector<std::optional<SurfaceHit>>& hits) {
  GroupSamples samples;
  samples.rays = static_cast<int>(hits.size());
  samples.hits.assign(kGroupLanes * hits.size(), std::nullopt);
  samples.outgoing.assign(kGroupLanes * hits.size(), Vec3f{0, 0, 1});
  for (std::size_t i = 0; i < hits.size(); ++i) samples.hits[i] = hits[i];
  return samples;
}

TEST(PixelSurfaces, LikeHitsShareOneSurfaceWithTheirMeanAlbedo) {
  const auto samples = one_pixel({hit_with({0, 1, 0}, 0.5f), hit_with({0.1f, 1, 0}, 0.54f),
                                  std::nullopt, hit_with({0, 1, 0.1f}, 0.52f)});
  PixelSurfaces surfaces;
  find_surfaces(samples, 0, surfaces);
  ASSERT_EQ(surfaces.size(), 1u);
  EXPECT_EQ(surfaces[0].hits.size(), 3u);
  EXPECT_FLOAT_EQ(surfaces[0].share, 0.75f);
  EXPECT_NEAR(surfaces[0].brdf.albedo.x, 0.52, 1e-6);
  EXPECT_FLOAT_EQ(samples.coverage(0), 0.75f);
  EXPECT_FLOAT_EQ(samples.coverage(1), 0.0f);
}

TEST(PixelSurfaces, OtherNormalsAndOtherMaterialsAreOtherSurfaces) {
  const auto samples = one_pixel({hit_with({0, 1, 0}, 0.5f), hit_with({1, 0, 0}, 0.5f),
                                  hit_with({0, 1, 0}, 0.9f), hit_with({0, 1, 0}, 0.5f)});
  PixelSurfaces surfaces;
  find_surfaces(samples, 0, surfaces);
  EXPECT_EQ(surfaces.size(), 3u);
}

TEST(PixelSurfaces, SharesSumToTheCoverageHoweverManyKindsThereAre) {
  Random random(8);
  std::vector<std::optional<SurfaceHit>> hits;
  for (int i = 0; i < 30; ++i) {
    const Vec3f normal(uniform_sphere(random_sample(random)));
    hits.emplace_back(hit_with(normal, static_cast<float>(random.uniform())));
  }
  // Opposite normals, whose sum is zero.
  hits.emplace_back(hit_with({0, 0, 1}, 0.5f));
  hits.emplace_back(hit_with({0, 0, -1}, 0.5f));
  PixelSurfaces surfaces;
  find_surfaces(one_pixel(hits), 0, surfaces);
  EXPECT_EQ(surfaces.size(), kMostSurfaces);
  float share = 0;
  std::size_t count = 0;
  for (const PixelSurface& surface : surfaces) {
    share += surface.share;
    count += surface.hits.size();
  }
  EXPECT_NEAR(share, 1, 1e-5);
  EXPECT_EQ(count, hits.size());
}

TEST(CheckLights, AreTheSameEveryTimeAndKeepTheirEnergyWhenTurned) {
  const CubeHaar haar(8);
  const auto lights = make_check_lights(haar);
  const auto again = make_check_lights(haar);
  ASSERT_EQ(lights.size(), 12u);
  const AlignedVector<float> angles = cube::texel_solid_angles(8);
  const auto energy = [&](const CheckLight& light) {
    CubeLight texels(8);
    haar.inverse(light.coefficients.channel(1), texels.channel(1));
    double sum = 0;
    for (std::size_t i = 0; i < texels.count(); ++i) {
      sum += static_cast<double>(texels.channel(1)[i]) * static_cast<double>(angles[i]);
    }
    return sum;
  };
  for (std::size_t i = 0; i < lights.size(); ++i) {
    EXPECT_EQ(lights[i].coefficients.values, again[i].coefficients.values);
    const double unrotated = energy(lights[lights[i].unrotated]);
    EXPECT_GT(unrotated, 0);
    EXPECT_NEAR(energy(lights[i]) / unrotated, 1, 1e-3) << lights[i].name;
  }
}

TEST(CheckLights, ATurnedLightIsNeverJudgedBrighterThanASessionShowsIt) {
  std::vector<CheckLight> lights(3);
  lights[1].unrotated = 0;
  lights[2].unrotated = 0;
  const LightImages images = {{{1, 1, 1}}, {{0.01f, 0.01f, 0.01f}}, {{10, 10, 10}}};
  const auto exposures = check_exposures(lights, images);
  EXPECT_NEAR(exposures[0], 0.18, 1e-6);
  EXPECT_NEAR(exposures[1], 0.18, 1e-6);   // dark: as its unrotated light
  EXPECT_NEAR(exposures[2], 0.018, 1e-7);  // bright: its own
}

TileCheck random_check(std::size_t lights) {
  Random random(9);
  TileCheck check;
  check.coverage.resize(kTileReceivers);
  for (float& value : check.coverage) value = random.uniform_float();
  check.images.assign(lights, std::vector<Vec3f>(kTileReceivers));
  check.reflectance.resize(kTileReceivers);
  for (Vec3f& value : check.reflectance) value = {1, random.uniform_float(), 0};
  for (auto& image : check.images) {
    for (Vec3f& pixel : image) pixel = {random.uniform_float(), 1, random.uniform_float()};
  }
  return check;
}

TEST(TileCheckFile, ComesBackOrNotAtAll) {
  const test::TemporaryFolder folder;
  const TileCheck check = random_check(3);
  save_check(folder / "a", check, 42);
  const auto loaded = load_check(folder / "a", 3, 42);
  ASSERT_TRUE(loaded.has_value());
  EXPECT_EQ(loaded->coverage, check.coverage);
  EXPECT_EQ(loaded->reflectance, check.reflectance);
  EXPECT_EQ(loaded->images, check.images);
  EXPECT_FALSE(load_check(folder / "a", 3, 43).has_value()) << "another bake's";
  EXPECT_FALSE(load_check(folder / "a", 2, 42).has_value()) << "other lights";
  EXPECT_FALSE(load_check(folder / "b", 3, 42).has_value()) << "missing";
}

TEST(TileCheckFile, DamageAnywhereIsFound) {
  const test::TemporaryFolder folder;
  save_check(folder / "a", random_check(1), 42);
  const std::string whole = read_file(folder / "a", std::size_t{1} << 24);
  Random random(10);
  for (int i = 0; i < 50; ++i) {
    std::string damaged = whole;
    const std::size_t at = random.below(damaged.size());
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << random.below(8)));
    std::ofstream(folder / "b", std::ios::binary) << damaged;
    EXPECT_FALSE(load_check(folder / "b", 1, 42).has_value()) << "byte " << at;
    std::ofstream(folder / "b", std::ios::binary) << whole.substr(0, at);
    EXPECT_FALSE(load_check(folder / "b", 1, 42).has_value()) << "cut at " << at;
  }
}

TEST(Fingerprint, ChangesWithEverythingThatABakeDependsOn) {
  const auto scene = corner_scene(lambert(0.5f));
  const std::uint64_t original = fingerprint(*scene);
  EXPECT_EQ(original, fingerprint(*corner_scene(lambert(0.5f))));
  const auto changed = [&](const auto& change) {
    Scene copy = *scene;
    change(copy);
    return fingerprint(copy) != original;
  };
  EXPECT_TRUE(changed([](Scene& s) { s.materials[0].brdf.albedo.y = 0.51f; }));
  EXPECT_TRUE(changed([](Scene& s) { s.materials[0].brdf.model = BrdfModel::phong; }));
  // What only anisotropic models know counts for them alone: other bakes keep their names.
  EXPECT_FALSE(changed([](Scene& s) { s.materials[0].tangent = {0, 1, 0}; }));
  EXPECT_FALSE(changed([](Scene& s) { s.materials[0].brdf.roughness_across = 0.5f; }));
  Scene ward = *scene;
  ward.materials[0].brdf.model = BrdfModel::ward;
  Scene across = ward, turned = ward;
  across.materials[0].brdf.roughness_across = 0.5f;
  turned.materials[0].tangent = {0, 1, 0};
  EXPECT_NE(fingerprint(ward), fingerprint(across));
  EXPECT_NE(fingerprint(ward), fingerprint(turned));
  EXPECT_TRUE(changed([](Scene& s) { s.meshes[1].positions[2].z += 1e-4f; }));
  EXPECT_TRUE(changed([](Scene& s) { s.meshes[1].triangles[0] = {0, 2, 1}; }));
  EXPECT_TRUE(changed([](Scene& s) { s.camera.position.x += 1e-9; }));
  EXPECT_TRUE(changed([](Scene& s) { s.bake.seed = 2; }));
  EXPECT_TRUE(changed([](Scene& s) { s.bake.psnr_db = 51; }));
  EXPECT_TRUE(changed([](Scene& s) { s.bake.bounces = 5; }));
}

}  // namespace
}  // namespace rimlight
