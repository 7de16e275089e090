// Bakes of kind brdf_curve by the built program: the picture, options, errors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/files.h"
#include "core/image/image_file.h"
#include "tests/support/brdf_files.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using nlohmann::json;
using test::ProgramResult;
using test::run_program;
using ::testing::HasSubstr;

/// A pearl ball and a gold box on a floor.
constexpr const char* kScene = R"({ "name": "ball",
    "camera": { "position": [0, 1.5, 4], "target": [0, 0.5, 0], "field_of_view": 35 },
    "materials": { "clay": { "model": "lambert", "albedo": [0.7, 0.5, 0.4] },
                   "pearl": { "model": "blinn_phong", "albedo": 0.3, "specular": 0.3 },
                   "gold": { "model": "cook_torrance", "roughness": 0.3,
                             "eta": [0.2, 0.5, 1.3], "k": [3.3, 2.3, 1.9] } },
    "objects": [ { "shape": "sphere", "radius": 0.6, "translate": [-0.4, 0.6, 0],
                   "material": "pearl" },
                 { "shape": "box", "size": [0.5, 0.8, 0.5], "translate": [0.7, 0.4, 0],
                   "material": "gold" },
                 { "shape": "plane", "size": [8, 8], "material": "clay" } ],
    "environments": ["studio"],
    "bake": { "kind": "brdf_curve", "width": 64, "height": 48, "cube_size": 16, "bounces": 1,
              "primary_rays": 4 } })";

class CurveProgram : public ::testing::Test {
 protected:
  CurveProgram() { std::ofstream(folder_ / "scene.json") << kScene; }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  ProgramResult bake(const std::string& name, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> command = {"bake", path("scene.json"), "-o", path(name), "--json"};
    command.insert(command.end(), more.begin(), more.end());
    return run_program(command);
  }
  json inspect(const std::string& name) const {
    const ProgramResult result = run_program({"inspect", path(name), "--verify", "--json"});
    EXPECT_EQ(result.status, 0) << result.errors;
    return json::parse(result.output);
  }
  /// What `render` displays of a bake, in display-referred linear numbers.
  RgbImage picture(const std::string& name, const std::string& rotation) const {
    const ProgramResult result =
        run_program({"render", path(name), "--rotation", rotation, "-o", path(name + ".png")});
    EXPECT_EQ(result.status, 0) << result.errors;
    return read_srgb_picture(path(name + ".png"));
  }

  test::TemporaryFolder folder_;
};

/// Of values as they are shown (read_srgb_picture() gives them linear again).
double display_psnr(const RgbImage& a, const RgbImage& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const auto shown = [c](const Vec3f& v) {
        return std::pow(std::max(0.0, static_cast<double>(v[c])), 1 / 2.2);
      };
      sum += std::pow(shown(a.pixels[i]) - shown(b.pixels[i]), 2);
    }
  }
  return -10 * std::log10(sum / static_cast<double>(3 * a.pixels.size()));
}

TEST_F(CurveProgram, ShowsThePictureThatABakeOfAllLightShows) {
  ASSERT_EQ(bake("curves.bake").status, 0);
  ASSERT_EQ(bake("image.bake", {"--kind", "image_haar"}).status, 0);
  for (const char* const rotation : {"0,0,0,1", "0,0.6,0,0.8"}) {
    const RgbImage image = picture("image.bake", rotation);
    ASSERT_EQ(image.width, 64);
    EXPECT_GE(display_psnr(picture("curves.bake", rotation), image), 40) << rotation;
  }
  EXPECT_LT(display_psnr(picture("curves.bake", "0,0,0,1"), picture("image.bake", "0,1,0,0")), 30);
  const json curves = inspect("curves.bake"), image = inspect("image.bake");
  EXPECT_EQ(curves.at("kind"), "brdf_curve");
  EXPECT_LT(curves.at("transport_bytes").get<int>(), image.at("transport_bytes").get<int>());
  EXPECT_FALSE(image.contains("curves"));
}

TEST_F(CurveProgram, InspectTellsWhatCurvesHold) {
  ASSERT_EQ(bake("a.bake", {"--width", "32", "--height", "32"}).status, 0);
  const json curves = inspect("a.bake").at("curves");
  ASSERT_EQ(curves.at("materials").size(), 2u);
  EXPECT_EQ(curves.at("materials")[1].at("name"), "pearl");
  EXPECT_EQ(curves.at("materials")[1].at("model"), "blinn_phong");
  std::size_t surfaces = 0;
  for (const json& material : curves.at("materials")) {
    EXPECT_GT(material.at("surfaces").get<int>(), 20);
    surfaces += material.at("surfaces").get<std::size_t>();
  }
  EXPECT_EQ(curves.at("surfaces"), surfaces);
  const auto mixed = curves.at("mixed_blocks").get<std::size_t>();
  EXPECT_EQ(curves.at("visibility_bytes"), surfaces * 24 + (surfaces + 1) * 8 + mixed * 32);
  EXPECT_EQ(curves.at("measured").size(), 0u);
  const ProgramResult text = run_program({"inspect", path("a.bake")});
  for (const char* const part : {"brdf_curve", "pearl", "cook_torrance", "of the sky"}) {
    EXPECT_THAT(text.output, HasSubstr(part));
  }
}

TEST_F(CurveProgram, MaterialsThatAreAllEditableMayLeaveTheTransportBlack) {
  std::string scene = kScene;
  scene.replace(scene.find("\"bounces\": 1"), 12, "\"bounces\": 0");
  std::ofstream(folder_ / "scene.json") << scene;
  const ProgramResult baked =
      bake("a.bake", {"--width", "32", "--height", "32", "--editable", "clay", "pearl", "gold"});
  ASSERT_EQ(baked.status, 0) << baked.errors;
  EXPECT_EQ(json::parse(baked.output).at("transport_bytes"), 0);
  EXPECT_EQ(inspect("a.bake").at("curves").at("materials").size(), 3u);
  ASSERT_EQ(bake("image.bake", {"--width", "32", "--height", "32", "--kind", "image_haar"}).status,
            0);
  EXPECT_GE(display_psnr(picture("a.bake", "0,0,0,1"), picture("image.bake", "0,0,0,1")), 40);
}

TEST_F(CurveProgram, MeasuredBrdfsAreFittedAndKept) {
  std::ofstream(folder_ / "silk.bsdf", std::ios::binary)
      << test::rgl_file(test::small_rgl_fields(0.5f, 1, {0.6f, 0.4f, 0.2f}));
  std::string scene = kScene;
  const std::string clay = R"("model": "lambert", "albedo": [0.7, 0.5, 0.4])";
  scene.replace(scene.find(clay), clay.size(), R"("model": "measured", "measured": "blue")");
  scene.replace(scene.find("\"materials\""), 0,
                R"("measured": ["silk.bsdf", { "file": "silk.bsdf", "name": "blue" }], )");
  std::ofstream(folder_ / "scene.json") << scene;
  const ProgramResult baked = bake("a.bake", {"--width", "24", "--height", "24"});
  ASSERT_EQ(baked.status, 0) << baked.errors;
  EXPECT_THAT(baked.errors, HasSubstr("silk: fitted with an error of"));
  const json fits = json::parse(baked.output).at("measured");
  ASSERT_EQ(fits.size(), 2u);
  for (const json& fit : fits) {
    EXPECT_GT(fit.at("fit_error_logarithmic")[0].get<double>(), 0);
    EXPECT_GT(fit.at("largest_albedo").get<double>(), 0.1);
  }
  const json curves = inspect("a.bake").at("curves");
  EXPECT_EQ(curves.at("materials")[0].at("model"), "measured");
  ASSERT_EQ(curves.at("measured").size(), 2u);
  EXPECT_EQ(curves.at("measured")[1].at("name"), "blue");
  EXPECT_EQ(curves.at("measured")[1].at("fit_error_relative"), fits[1].at("fit_error_relative"));
  EXPECT_THAT(run_program({"inspect", path("a.bake")}).output, HasSubstr("blue"));
  picture("a.bake", "0,0,0,1");
  // A base material in the other kinds, too.
  ASSERT_EQ(bake("image.bake", {"--width", "24", "--height", "24", "--kind", "image_haar"}).status,
            0);
  EXPECT_GE(display_psnr(picture("a.bake", "0,0,0,1"), picture("image.bake", "0,0,0,1")), 40);
}

TEST_F(CurveProgram, WhatCannotBeEditedIsAnErrorAndLeavesNothing) {
  struct Case {
    std::vector<std::string> options;
    std::string expected;
  };
  for (const Case& one :
       {Case{{"--editable", "brass"}, "found \"brass\", expected the name of a material"},
        Case{{"--kind", "image_haar", "--editable", "gold"}, "expected --kind brdf_curve"},
        Case{{"--kind", "vertex_sh", "--editable", "gold"}, "expected --kind brdf_curve"},
        Case{{"--cube-size", "4"}, "cube_size: found 4, expected at least 8"}}) {
    const ProgramResult result = bake("a.bake", one.options);
    EXPECT_EQ(result.status, 1);
    EXPECT_THAT(result.errors, HasSubstr(one.expected));
    EXPECT_EQ(result.output, "");
  }
  EXPECT_EQ(bake("a.bake", {"--editable"}).status, 2);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.bake"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.bake.partial"));
}

}  // namespace
}  // namespace rimlight
