#include "core/bake/vertex_sh_bake.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/files.h"
#include "core/base/parallel.h"
#include "core/basis/sh.h"
#include "core/basis/sh_zonal.h"
#include "core/transport/vertex_bake.h"
#include "tests/core/bake/bake_scenes.h"
#include "tests/core/scene/scene_cases.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

/// A red ball with a highlight over a grey floor.
std::shared_ptr<Scene> ball_scene() {
  auto scene = std::make_shared<Scene>();
  scene->name = "ball";
  scene->camera.position = {0, 2, 5};
  Material red = lambert(0.5f);
  red.brdf = {.model = BrdfModel::phong,
              .albedo = {0.8f, 0.1f, 0.1f},
              .specular = {0.1f, 0.1f, 0.1f},
              .exponent = 20};
  scene->materials = {lambert(0.5f), red};
  scene->meshes = {quad({-3, 0, -3}, {6, 0, 0}, {0, 0, 6}, 0), test_sphere({0, 1.2f, 0}, 1, 10)};
  scene->meshes[0].normals.assign(4, {0, 1, 0});
  for (const Vec3f& p : scene->meshes[1].positions) {
    scene->meshes[1].normals.push_back(Vec3f(normalized(Vec3d(p) - Vec3d(0, 1.2, 0))));
  }
  scene->meshes[1].material = 1;
  scene->environments.emplace_back("even", RgbImage(4, 2), EnvironmentLayout::lat_long);
  scene->bake.kind = BakeKind::vertex_sh;
  scene->bake.width = 300;
  scene->bake.height = 200;
  scene->bake.vertex = {.degree = 5, .error = 0.02, .longest_edge = 0};
  return scene;
}

std::map<std::string, std::string> contents(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    files[entry.path().filename().string()] = read_file(entry.path(), SIZE_MAX);
  }
  return files;
}

TEST(VertexShBake, WritesWhatTheSceneAsksFor) {
  const test::TemporaryFolder folder;
  std::vector<std::string> stages;
  const auto scene = ball_scene();
  scene->bake.vertex.keep_bands = true;
  const VertexBakeSummary summary =
      bake_vertices(scene, folder / "a.bake", [&](const BakeProgress& progress) {
        if (stages.empty() || stages.back() != progress.stage) stages.push_back(progress.stage);
        EXPECT_TRUE(progress.fraction >= 0 && progress.fraction <= 1);
      });
  EXPECT_EQ(stages, (std::vector<std::string>{"tracing visibility", "tracing surfaces",
                                              "bouncing light", "writing"}));
  const VertexBake bake(folder / "a.bake");
  bake.verify();
  EXPECT_EQ(bake.scene(), "ball");
  EXPECT_EQ(bake.width(), 300);
  EXPECT_EQ(bake.camera().position, Vec3d(0, 2, 5));
  EXPECT_EQ(summary.vertices, bake.transport().vertex_count);
  EXPECT_EQ(bake.transport().highlight_count, summary.vertices - 4);
  EXPECT_EQ(bake.settings()["degree"], 5);
  EXPECT_EQ(bake.settings()["transfer"], "interreflected");
  EXPECT_EQ(bake.left_out()["visibility"]["vertices_left_out"], 4);
  EXPECT_GT(bake.measured()["visibility"]["rays"].get<std::size_t>(), 1000u);
  EXPECT_EQ(bake.environments().size(), 1u);
  EXPECT_EQ(bake.transport().irradiance_channels, 3u);  // red light on the floor
  EXPECT_LE(summary.worst_error, 0.02);
}

TEST(VertexShBake, RedComesFromTheBallAndItsBottomIsDark) {
  auto scene = ball_scene();
  scene->bake.vertex.keep_bands = true;
  const PreparedVertices prepared = prepare_vertices(*scene);
  const auto calculated = calculate_vertices(*scene, prepared, {});
  const auto& channels = calculated.transport.irradiance;
  ASSERT_EQ(channels.size(), 3u);
  int floors = 0;
  for (std::size_t v = 0; v < prepared.mesh.positions.size(); ++v) {
    const double red = channels[0][v * 36], blue = channels[2][v * 36];
    if (prepared.mesh.positions[v].y == 0) {
      EXPECT_GT(red, blue);
      ++floors;
    }
    // c00 of the clamped cosine is √π/2.
    EXPECT_LT(red, std::sqrt(std::numbers::pi) / 2 * 1.03);
    EXPECT_GE(red, 0);
  }
  EXPECT_EQ(floors, 4);
}

TEST(VertexShBake, TheBytesDoNotDependOnThreads) {
  const test::TemporaryFolder folder;
  const auto scene = ball_scene();
  scene->bake.vertex.longest_edge = 0.07;
  const VertexBakeSummary summary = bake_vertices(scene, folder / "all.bake", {});
  EXPECT_GT(summary.vertices - summary.highlight_vertices, 200u);  // of the floor
  set_thread_count(1);
  bake_vertices(scene, folder / "one.bake", {});
  set_thread_count(3);
  bake_vertices(scene, folder / "three.bake", {});
  set_thread_count(0);
  const auto all = contents(folder / "all.bake");
  ASSERT_EQ(all.size(), 5u);
  EXPECT_EQ(all, contents(folder / "one.bake"));
  EXPECT_EQ(all, contents(folder / "three.bake"));
}

TEST(VertexShBake, UnshadowedTransportIsTheClampedCosine) {
  auto scene = ball_scene();
  scene->bake.vertex.transfer = VertexTransfer::unshadowed;
  const PreparedVertices prepared = prepare_vertices(*scene);
  const CalculatedVertices calculated = calculate_vertices(*scene, prepared, {});
  EXPECT_EQ(calculated.rays, 0u);
  EXPECT_TRUE(calculated.transport.is_open);
  ASSERT_EQ(calculated.transport.irradiance.size(), 1u);
  const auto lobe = sh::clamped_cosine_lobe(5);
  for (std::size_t v = 0; v < prepared.mesh.normals.size(); ++v) {
    const auto expected = sh::turned_lobe(lobe, Vec3d(prepared.mesh.normals[v]));
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_NEAR(calculated.transport.irradiance[0][v * 36 + i], expected[i], 1e-6);
    }
  }
}

TEST(VertexShBake, UnshadowedIrradianceIsNotStoredButToWhatDegreeItIsNeeded) {
  const test::TemporaryFolder folder;
  auto scene = ball_scene();
  scene->bake.vertex.transfer = VertexTransfer::unshadowed;
  for (const auto& [error, degree] : {std::pair{0.1, 2}, {0.05, 4}}) {
    scene->bake.vertex.error = error;
    bake_vertices(scene, folder / "a.bake", {});
    const VertexBake bake(folder / "a.bake");
    EXPECT_EQ(bake.transport().irradiance_channels, 0u);
    EXPECT_EQ(bake.transport().irradiance.size(), 0u);
    EXPECT_EQ(bake.transport().normals.data(), bake.mesh().normals.data());
    EXPECT_EQ(bake.transport().irradiance_degree, degree);
    const auto& left_out = bake.left_out()["irradiance"];
    EXPECT_EQ(left_out["follows_from_normals"], true);
    EXPECT_LE(left_out["relative_error"].get<double>(), error);
    EXPECT_EQ(bake.settings()["sun"], "directional");
  }
  scene->bake.vertex.sun = SunLight::harmonics;
  for (Material& material : scene->materials)
    material.subsurface = Subsurface{{1, 1, 1}, {20, 20, 20}};
  bake_vertices(scene, folder / "b.bake", {});
  const VertexBake spread(folder / "b.bake");  // light goes through it
  EXPECT_EQ(spread.transport().irradiance_channels, 1u);
  EXPECT_EQ(spread.left_out()["irradiance"]["follows_from_normals"], false);
  EXPECT_EQ(spread.settings()["sun"], "harmonics");
}

TEST(VertexShBake, AnOpenMattSceneStoresNoTransportAtAll) {
  const test::TemporaryFolder folder;
  auto scene = ball_scene();
  scene->bake.vertex.transfer = VertexTransfer::unshadowed;
  scene->materials = {lambert(0.5f), lambert(0.2f)};
  const VertexBakeSummary summary = bake_vertices(scene, folder / "a.bake", {});
  EXPECT_EQ(summary.bytes, 0u);
  const VertexBake bake(folder / "a.bake");
  bake.verify();
  EXPECT_EQ(bake.transport().highlight_count, 0u);
  EXPECT_EQ(bake.transport().irradiance_channels, 0u);
}

TEST(VertexShBake, TheSunIsApartWhereNothingOfItsLightIsLost) {
  const test::TemporaryFolder folder;
  const auto sun_of = [&](VertexTransfer transfer, std::optional<SunLight> asked) {
    auto scene = ball_scene();
    scene->bake.vertex.transfer = transfer;
    scene->bake.vertex.error = 0.2;
    scene->bake.vertex.sun = asked;
    bake_vertices(scene, folder / "a.bake", {});
    return VertexBake(folder / "a.bake").settings()["sun"].get<std::string>();
  };
  EXPECT_EQ(sun_of(VertexTransfer::shadowed, {}), "directional");
  EXPECT_EQ(sun_of(VertexTransfer::interreflected, {}), "harmonics");
  EXPECT_EQ(sun_of(VertexTransfer::interreflected, SunLight::directional), "directional");
  EXPECT_EQ(sun_of(VertexTransfer::shadowed, SunLight::harmonics), "harmonics");
}

TEST(VertexShBake, ShadowsTakeLightAndBouncesGiveSomeBack) {
  const auto mean_light = [](VertexTransfer transfer) {
    auto scene = ball_scene();
    scene->bake.vertex.transfer = transfer;
    const PreparedVertices prepared = prepare_vertices(*scene);
    const auto calculated = calculate_vertices(*scene, prepared, {});
    double sum = 0;
    for (std::size_t v = 0; v < prepared.mesh.positions.size(); ++v) {
      sum += calculated.transport.irradiance[0][v * 36];
    }
    return sum;
  };
  const double whole = mean_light(VertexTransfer::unshadowed);
  const double shadowed = mean_light(VertexTransfer::shadowed);
  const double all = mean_light(VertexTransfer::interreflected);
  EXPECT_LT(shadowed, 0.9 * whole);
  EXPECT_GT(all, 1.05 * shadowed);
  EXPECT_LT(all, whole);
}

TEST(VertexShBake, ATranslucentBallIsLitBelow) {
  auto scene = ball_scene();
  scene->bake.vertex.transfer = VertexTransfer::shadowed;
  const auto lowest = [&] {
    const PreparedVertices prepared = prepare_vertices(*scene);
    const auto calculated = calculate_vertices(*scene, prepared, {});
    const auto& positions = prepared.mesh.positions;
    std::size_t found = 0;
    for (std::size_t v = 0; v < prepared.highlight_count; ++v) {
      if (positions[v].y < positions[found].y) found = v;
    }
    return calculated.transport.irradiance[0][found * 36];
  };
  const float opaque = lowest();
  scene->materials[1].subsurface = Subsurface{{0.01f, 0.1f, 1}, {1, 1, 1}, 1.3f};
  EXPECT_GT(lowest(), 1.5f * opaque);
}

TEST(VertexShBake, ErrorsLeaveNothingBehind) {
  const test::TemporaryFolder folder;
  auto scene = ball_scene();
  scene->bake.vertex.degree = 21;
  EXPECT_THAT(test::error_of([&] { bake_vertices(scene, folder / "a.bake", {}); }),
              testing::HasSubstr("degree 21, expected 0 to 20"));
  scene = ball_scene();
  scene->meshes.clear();
  EXPECT_THAT(test::error_of([&] { bake_vertices(scene, folder / "a.bake", {}); }),
              testing::HasSubstr("no triangles"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace rimlight
