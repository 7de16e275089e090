#include "core/vertices/vertex_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "tests/core/vertices/vertex_case.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using testing::HasSubstr;

/// The error of a good scene after a change of its mesh and of itself.
template <typename Change>
std::string fault_after(const Change& change) {
  VertexScene scene = test::VertexCase().scene;
  auto mesh = std::make_shared<VertexMesh>(*scene.mesh);
  change(scene, *mesh);
  if (scene.mesh) scene.mesh = mesh;
  return test::error_of([&] { check_vertex_scene(scene); });
}

TEST(VertexScene, AWholeOneIsTaken) {
  EXPECT_EQ(fault_after([](VertexScene&, VertexMesh&) {}), "no error");
}

TEST(VertexScene, PartsThatDoNotFitAreNamed) {
  const auto fault = [](const auto& change) {
    return fault_after([&](VertexScene&, VertexMesh& mesh) { change(mesh); });
  };
  EXPECT_THAT(fault([](VertexMesh& mesh) { mesh.normals.pop_back(); }), HasSubstr("case: normals"));
  EXPECT_THAT(fault([](VertexMesh& mesh) { mesh.tints.pop_back(); }), HasSubstr("case: tints"));
  EXPECT_THAT(fault([](VertexMesh& mesh) { mesh.materials[5] = 3; }),
              HasSubstr("case: material of a vertex: found 3, expected less than 3"));
  EXPECT_THAT(fault([](VertexMesh& mesh) { mesh.triangles[7][2] = 1'000'000; }),
              HasSubstr("case: corner of a triangle"));
  EXPECT_THAT(
      fault([](VertexMesh& mesh) { mesh.normals[1].x = std::numeric_limits<float>::infinity(); }),
      HasSubstr("case: normals: found a number that is not finite"));
}

TEST(VertexScene, TransportThatDoesNotFitIsNamed) {
  const auto fault = [](const auto& change) {
    return fault_after([&](VertexScene& scene, VertexMesh&) { change(scene.transport); });
  };
  EXPECT_THAT(fault([](VertexTransportView& t) { --t.vertex_count; }), HasSubstr("vertices"));
  EXPECT_THAT(fault([](VertexTransportView& t) { t.highlight_count = t.vertex_count + 1; }),
              HasSubstr("with a highlight"));
  EXPECT_THAT(fault([](VertexTransportView& t) { t.irradiance_degree = 33; }),
              HasSubstr("irradiance degree: found 33, expected 0 to 32"));
  EXPECT_THAT(fault([](VertexTransportView& t) { t.irradiance_channels = 2; }),
              HasSubstr("channels: found 2"));
  EXPECT_THAT(fault([](VertexTransportView& t) { t.irradiance = t.irradiance.subspan(1); }),
              HasSubstr("transport: irradiance"));
  EXPECT_THAT(fault([](VertexTransportView& t) { t.visibility = {}; }),
              HasSubstr("transport: visibility"));
}

TEST(VertexScene, WhatIsMissingOrOutOfRangeIsNamed) {
  const auto fault = [](const auto& change) {
    return fault_after([&](VertexScene& scene, VertexMesh&) { change(scene); });
  };
  EXPECT_THAT(fault([](VertexScene& s) { s.mesh = nullptr; }), HasSubstr("case: mesh: found none"));
  EXPECT_THAT(fault([](VertexScene& s) { s.materials.clear(); }), HasSubstr("case: materials"));
  EXPECT_THAT(fault([](VertexScene& s) { s.environments.clear(); }),
              HasSubstr("case: environments"));
  EXPECT_THAT(fault([](VertexScene& s) { s.width = 0; }), HasSubstr("case: width"));
  EXPECT_THAT(fault([](VertexScene& s) { s.height = 20'000; }), HasSubstr("case: height"));
  EXPECT_THAT(fault([](VertexScene& s) { s.materials[0].exponent = -1; }), HasSubstr("exponent"));
  EXPECT_THAT(fault([](VertexScene& s) { s.camera.target = s.camera.position; }),
              HasSubstr("case: camera/target"));
}

/// The case as a bake on disk, opened.
std::shared_ptr<const VertexBake> bake_of(const VertexScene& scene,
                                          const std::filesystem::path& folder,
                                          const nlohmann::json& settings) {
  BakeWriter writer(folder);
  for (const BakedEnvironment& environment : scene.environments) {
    writer.add_environment(environment);
  }
  VertexBakeManifest manifest{.scene = "case",
                              .width = scene.width,
                              .height = scene.height,
                              .camera = scene.camera,
                              .materials = scene.materials};
  manifest.settings = settings;
  commit_vertex_bake(writer, manifest, *scene.mesh, scene.transport);
  return std::make_shared<const VertexBake>(folder);
}

TEST(VertexScene, ABakeShowsTheSameFrames) {
  const test::TemporaryFolder folder;
  const VertexScene scene = test::VertexCase().scene;
  const auto frame_of = [](const VertexScene& shown) {
    VertexRenderer renderer(std::make_shared<const VertexScene>(shown), test::kVertexSettings);
    DesignState state;
    state.environment = "dim";
    Rgb8Image frame;
    FrameReport report;
    EXPECT_TRUE(renderer.render_exact(state, frame, report));
    return frame.bytes;
  };
  const VertexScene opened =
      vertex_scene_of(bake_of(scene, folder / "a.bake", nlohmann::json::object()));
  check_vertex_scene(opened);
  EXPECT_EQ(frame_of(opened), frame_of(scene));
}

TEST(VertexScene, ABakeSaysWhetherLightWentFromSurfaceToSurface) {
  const test::TemporaryFolder folder;
  const auto has = [&](std::size_t channels, const nlohmann::json& settings) {
    const VertexScene scene = test::VertexCase({.channels = channels}).scene;
    return vertex_scene_of(bake_of(scene, folder / "b.bake", settings)).has_interreflection;
  };
  EXPECT_TRUE(has(1, {{"transfer", "interreflected"}}));
  EXPECT_FALSE(has(3, {{"transfer", "shadowed"}}));
  EXPECT_TRUE(has(3, nlohmann::json::object()));
  EXPECT_FALSE(has(1, nlohmann::json::object()));
}

}  // namespace
}  // namespace rimlight
