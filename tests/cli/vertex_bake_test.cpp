// Bakes of vertices by the built program: options, results, errors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using nlohmann::json;
using test::ProgramResult;
using test::run_program;
using ::testing::HasSubstr;

/// A varnished ball on a floor.
std::string scene_with(const std::string& bake) {
  return R"({ "name": "ball",
    "camera": { "position": [0, 1.5, 4], "target": [0, 0.5, 0], "field_of_view": 35 },
    "materials": { "clay": { "model": "lambert", "albedo": [0.7, 0.5, 0.4] },
                   "varnish": { "model": "phong", "albedo": 0.3, "specular": 0.2 } },
    "objects": [ { "shape": "sphere", "radius": 0.6, "segments": 12, "translate": [0, 0.6, 0],
                   "material": "varnish" },
                 { "shape": "plane", "size": [8, 8], "material": "clay" } ],
    "environments": ["studio"], "bake": )" +
         bake + " }";
}

class VertexProgram : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  std::string write_scene(const std::string& bake) {
    std::ofstream(folder_ / "scene.json") << scene_with(bake);
    return path("scene.json");
  }

  test::TemporaryFolder folder_;
};

TEST_F(VertexProgram, BakesAndInspects) {
  const std::string scene = write_scene(
      R"({ "kind": "vertex_sh", "degree": 6, "error": 0.03, "longest_edge": 0, "width": 64 })");
  const ProgramResult baked = run_program({"bake", scene, "-o", path("a.bake"), "--json"});
  ASSERT_EQ(baked.status, 0) << baked.errors;
  EXPECT_THAT(baked.errors, HasSubstr("tracing visibility"));
  const json summary = json::parse(baked.output);
  EXPECT_LE(summary.at("worst_error").get<double>(), 0.03);
  EXPECT_EQ(summary.at("capped_vertices"), 0);
  EXPECT_EQ(summary.at("vertices").get<int>() - summary.at("highlight_vertices").get<int>(), 4);

  const ProgramResult inspected = run_program({"inspect", path("a.bake"), "--verify", "--json"});
  ASSERT_EQ(inspected.status, 0) << inspected.errors;
  const json bake = json::parse(inspected.output);
  EXPECT_EQ(bake.at("kind"), "vertex_sh");
  EXPECT_EQ(bake.at("verified"), true);
  EXPECT_EQ(bake.at("vertices"), summary.at("vertices"));
  EXPECT_EQ(bake.at("settings").at("degree"), 6);
  EXPECT_EQ(bake.at("transport_bytes"), summary.at("transport_bytes"));
  EXPECT_EQ(bake.at("irradiance_energy").size(),
            bake.at("irradiance_degree").get<std::size_t>() + 1);
  EXPECT_GT(bake.at("irradiance_energy")[0].get<double>(), 0.1);
  EXPECT_EQ(bake.at("left_out").at("visibility").at("vertices_left_out"), 4);
  EXPECT_EQ(bake.at("materials").size(), 2u);
  const ProgramResult text = run_program({"inspect", path("a.bake")});
  for (const char* const part : {"vertex_sh", "varnish", "left out", "mean energy by degree"}) {
    EXPECT_THAT(text.output, HasSubstr(part));
  }
}

TEST_F(VertexProgram, OptionsTakeThePlaceOfTheScenes) {
  const std::string scene = write_scene(R"({ "width": 64, "height": 64 })");
  const ProgramResult baked =
      run_program({"bake", scene, "-o", path("a.bake"), "--kind", "vertex_sh", "--degree", "3",
                   "--error", "0.05", "--transfer", "unshadowed", "--most-rays", "100",
                   "--keep-bands", "--longest-edge", "0.1", "--json"});
  ASSERT_EQ(baked.status, 0) << baked.errors;
  const json settings =
      json::parse(run_program({"inspect", path("a.bake"), "--json"}).output).at("settings");
  EXPECT_EQ(settings.at("degree"), 3);
  EXPECT_EQ(settings.at("error"), 0.05);
  EXPECT_EQ(settings.at("transfer"), "unshadowed");
  EXPECT_EQ(settings.at("most_rays"), 100);
  EXPECT_EQ(settings.at("keep_bands"), true);
  EXPECT_EQ(settings.at("longest_edge"), 0.1);
  EXPECT_GT(json::parse(baked.output).at("vertices").get<int>(), 250);  // 4 of the floor were
  EXPECT_EQ(json::parse(baked.output).at("irradiance_degree"), 3);
}

TEST_F(VertexProgram, WhatDoesNotFitIsAnErrorAndLeavesNothing) {
  const std::string scene = write_scene(R"({ "kind": "vertex_sh" })");
  for (const std::vector<std::string>& bad : {std::vector<std::string>{"--degree", "21"},
                                              {"--degree", "-1"},
                                              {"--error", "0"},
                                              {"--error", "nan"},
                                              {"--transfer", "magic"},
                                              {"--most-rays", "1"},
                                              {"--longest-edge", "-0.1"},
                                              {"--longest-edge", "nan"},
                                              {"--kind", "cloud"}}) {
    std::vector<std::string> command = {"bake", scene, "-o", path("a.bake")};
    command.insert(command.end(), bad.begin(), bad.end());
    EXPECT_EQ(run_program(command).status, 2) << bad[0] << " " << bad[1];
  }
  const ProgramResult of_images =
      run_program({"bake", scene, "-o", path("a.bake"), "--cube-size", "16"});
  EXPECT_EQ(of_images.status, 1);
  EXPECT_THAT(of_images.errors, HasSubstr("vertex_sh"));
  const ProgramResult of_vertices =
      run_program({"bake", scene, "-o", path("a.bake"), "--kind", "image_haar", "--degree", "4"});
  EXPECT_EQ(of_vertices.status, 1);
  EXPECT_THAT(of_vertices.errors, HasSubstr("image_haar"));
  const ProgramResult degree = run_program(
      {"bake", write_scene(R"({ "kind": "vertex_sh", "degree": 21 })"), "-o", path("a.bake")});
  EXPECT_EQ(degree.status, 1);
  EXPECT_THAT(degree.errors, HasSubstr("/bake/degree"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.bake"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.bake.partial"));
}

}  // namespace
}  // namespace rimlight
