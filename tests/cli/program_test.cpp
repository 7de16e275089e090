// The program from outside: exit statuses, errors, results, and a bake that survives kill -9.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "core/base/files.h"
#include "core/image/codec.h"
#include "core/image/image_file.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using nlohmann::json;
using test::ProgramResult;
using test::run_program;
using ::testing::HasSubstr;

constexpr std::size_t kMostBytes = std::size_t{1} << 28;

void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// A ball on a floor; `width` × 64 pixels, a tile for each 64.
std::string small_scene(int width, int primary_rays = 4) {
  return R"({ "name": "ball",
    "camera": { "position": [0, 1.5, 4], "target": [0, 0.5, 0], "field_of_view": 35 },
    "materials": { "clay": { "model": "lambert", "albedo": [0.7, 0.5, 0.4] } },
    "objects": [ { "shape": "sphere", "radius": 0.6, "translate": [0, 0.6, 0], "material": "clay" },
                 { "shape": "plane", "size": [8, 8], "material": "clay" } ],
    "environments": ["studio"],
    "bake": { "width": )" +
         std::to_string(width) + R"(, "height": 64, "cube_size": 8, "bounces": 1, "psnr_db": 40,
              "primary_rays": )" +
         std::to_string(primary_rays) + " } }";
}

/// A folder with a scene and its bake, made once for this binary's tests.
class Program : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  void bake_scene() {
    write(folder_ / "scene.json", small_scene(64));
    const ProgramResult result = run_program({"bake", path("scene.json"), "-o", path("a.bake")});
    ASSERT_EQ(result.status, 0) << result.errors;
  }

  test::TemporaryFolder folder_;
};

TEST_F(Program, WrongUsageEndsWithTwoAndHelpWithZero) {
  EXPECT_EQ(run_program({}).status, 2);
  EXPECT_EQ(run_program({"paint"}).status, 2);
  EXPECT_EQ(run_program({"bake"}).status, 2);
  EXPECT_EQ(run_program({"bake", "x.json", "--cube-size", "7"}).status, 2);
  EXPECT_EQ(run_program({"render", "a.bake", "--rotation", "1,2"}).status, 2);
  for (const char* command : {"bake", "import", "inspect", "render", "serve", "load"}) {
    const ProgramResult help = run_program({command, "--help"});
    EXPECT_EQ(help.status, 0);
    EXPECT_THAT(help.output, HasSubstr("--json")) << command;
  }
  EXPECT_EQ(run_program({"--version"}).status, 0);
}

TEST_F(Program, BadScenesEndWithOneNameTheFieldAndLeaveNothing) {
  struct Case {
    std::string text, expected;
  };
  std::string unknown_material = small_scene(64);
  unknown_material.replace(unknown_material.find("\"material\": \"clay\""), 18,
                           "\"material\": \"brass\"");
  for (const Case& one : {Case{"{ \"name\": ", "line 1"},
                          Case{unknown_material, "/objects/0/material"}, Case{"[]", "an object"}}) {
    write(folder_ / "bad.json", one.text);
    const ProgramResult result = run_program({"bake", path("bad.json"), "-o", path("bad.bake")});
    EXPECT_EQ(result.status, 1);
    EXPECT_THAT(result.errors, HasSubstr("bad.json"));
    EXPECT_THAT(result.errors, HasSubstr(one.expected));
    EXPECT_EQ(result.output, "");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "bad.bake"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "bad.bake.partial"));
  }
  EXPECT_EQ(run_program({"bake", path("missing.json")}).status, 1);
}

TEST_F(Program, ServeTakesEveryPolicyAndListsThemForAnyOther) {
  const std::string missing = path("missing.bake");
  for (const char* const policy : {"linear", "nwa", "bi:unweighted", "pbi:exhaustive", "benefit"}) {
    const ProgramResult taken = run_program({"serve", missing, "--policy", policy});
    EXPECT_EQ(taken.status, 1) << "it is the bake that is wrong";
    EXPECT_THAT(taken.errors, HasSubstr("missing.bake")) << policy;
  }
  const ProgramResult refused = run_program({"serve", missing, "--policy", "pbi:deal"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.errors, HasSubstr("\"dealer\""));
  write(folder_ / "server.json", R"({ "policy": "best" })");
  const ProgramResult configured = run_program({"serve", missing, "--config", path("server.json")});
  EXPECT_EQ(configured.status, 1);
  EXPECT_THAT(configured.errors, HasSubstr("server.json: /policy: found \"best\""));
  for (const char* const name : {"linear", "nwa", "bi", "pbi", "benefit"}) {
    EXPECT_THAT(configured.errors, HasSubstr(name));
  }
}

TEST_F(Program, BakesInspectsAndRenders) {
  bake_scene();
  const ProgramResult inspected = run_program({"inspect", path("a.bake"), "--verify", "--json"});
  ASSERT_EQ(inspected.status, 0) << inspected.errors;
  const json bake = json::parse(inspected.output);
  EXPECT_EQ(bake.at("scene"), "ball");
  EXPECT_EQ(bake.at("columns"), 6 * 8 * 8);
  EXPECT_EQ(bake.at("bands").size(), 3u);
  EXPECT_GE(bake.at("left_out").at("worst_psnr_db").get<double>(), 40);
  EXPECT_EQ(bake.at("verified"), true);

  for (const char* name : {"a.png", "b.png", "a.exr"}) {
    const ProgramResult rendered =
        run_program({"render", path("a.bake"), "--light", "studio", "-o", path(name), "--json"});
    ASSERT_EQ(rendered.status, 0) << rendered.errors;
    EXPECT_EQ(json::parse(rendered.output).at("light"), "studio");
  }
  const std::string png = read_file(folder_ / "a.png", kMostBytes);
  EXPECT_EQ(png, read_file(folder_ / "b.png", kMostBytes));
  const Rgb8Image image =
      decode_png(reinterpret_cast<const std::uint8_t*>(png.data()), png.size(), "a.png");
  EXPECT_EQ(image.width, 64);
  const RgbImage radiance = read_radiance(folder_ / "a.exr");
  EXPECT_EQ(radiance.height, 64);
  EXPECT_GT(max_component(radiance.at(32, 32)), 0);
}

TEST_F(Program, ATurnedLightAFileAndAnExposureChangeThePicture) {
  bake_scene();
  RgbImage bright(32, 16);
  for (Vec3f& pixel : bright.pixels) pixel = {2, 1, 1};
  write_exr(folder_ / "bright.exr", bright);
  const std::vector<std::vector<std::string>> cases = {
      {}, {"--rotation", "0,1,0,1"}, {"--exposure", "1"}, {"--light", path("bright.exr")}};
  std::vector<std::string> pictures;
  for (const auto& extra : cases) {
    std::vector<std::string> arguments = {"render", path("a.bake"), "-o", path("x.png")};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    const ProgramResult result = run_program(arguments);
    ASSERT_EQ(result.status, 0) << result.errors;
    pictures.push_back(read_file(folder_ / "x.png", kMostBytes));
    for (std::size_t i = 0; i + 1 < pictures.size(); ++i) EXPECT_NE(pictures[i], pictures.back());
  }
}

TEST_F(Program, BadRenderRequestsSayWhatWasExpected) {
  bake_scene();
  const ProgramResult light = run_program({"render", path("a.bake"), "--light", "moon"});
  EXPECT_EQ(light.status, 1);
  EXPECT_THAT(light.errors, HasSubstr("\"moon\""));
  EXPECT_THAT(light.errors, HasSubstr("studio"));
  EXPECT_EQ(run_program({"render", path("a.bake"), "--rotation", "0,0,0,0"}).status, 1);
  EXPECT_EQ(run_program({"render", path("a.bake"), "-o", path("a.gif")}).status, 1);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.gif"));
  write(folder_ / "cut.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100000 +X 100000\n");
  const ProgramResult huge = run_program({"render", path("a.bake"), "--light", path("cut.hdr")});
  EXPECT_EQ(huge.status, 1);
  EXPECT_THAT(huge.errors, HasSubstr("cut.hdr"));
}

TEST_F(Program, LoadPlaysOnlySequencesThatEditsCanShow) {
  // Refused before any server is looked for: there is none at this address.
  const auto load = [](const std::vector<std::string>& extra) {
    std::vector<std::string> arguments = {"load", "--url", "ws://127.0.0.1:1"};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    return run_program(arguments);
  };
  for (const char* name : {"area-light", "blend", "flicker", "paint"}) {
    const ProgramResult result = load({"--sequence", name});
    EXPECT_EQ(result.status, 1);
    EXPECT_THAT(result.errors, HasSubstr("sequence \"" + std::string(name) + "\": found light"));
  }
  EXPECT_THAT(load({"--sequence", "rotation"}).errors, HasSubstr("127.0.0.1:1"));
  EXPECT_THAT(load({"--sequence", "spin"}).errors, HasSubstr("\"rotation\""));
  write(folder_ / "bad.json", R"({"tracks": [{"light": "moon"}]})");
  EXPECT_THAT(load({"--sequence", path("bad.json")}).errors, HasSubstr("/tracks/0/light"));
  EXPECT_EQ(load({"--sequence", "rotation", "--script", "x.json"}).status, 2);
}

TEST_F(Program, ReportsStabilityAndFailsWhereACaseDoes) {
  const ProgramResult sound = run_program(
      {"report", "stability", "--case", "poles", "all-black", "-o", path("report"), "--json"});
  ASSERT_EQ(sound.status, 0) << sound.errors;
  const json report = json::parse(sound.output);
  EXPECT_EQ(report.at("failed"), 0);
  ASSERT_EQ(report.at("rows").size(), 2u);
  EXPECT_EQ(report.at("rows")[0].at("case"), "all-black");
  EXPECT_EQ(report, json::parse(read_file(folder_ / "report" / "stability.json", kMostBytes)));

  const ProgramResult broken =
      run_program({"report", "stability", "--break", "poles", "-o", path("report"), "--json"});
  EXPECT_EQ(broken.status, 1);
  EXPECT_EQ(json::parse(broken.output).at("rows")[0].at("pass"), false);
  EXPECT_THAT(broken.errors, HasSubstr("expected at most 2.5e-12 (what sh::evaluate() promises"));

  const ProgramResult list = run_program({"report", "stability", "--list"});
  EXPECT_EQ(list.status, 0);
  EXPECT_THAT(list.output, HasSubstr("one-column-a-frame"));
  EXPECT_EQ(run_program({"report", "stability", "--part", "weather"}).status, 1);
  EXPECT_EQ(run_program({"report", "stability", "--edits", "0"}).status, 2);
}

TEST_F(Program, ReportsErrorAgainstTimeToFilesAndOutput) {
  write(folder_ / "scene.json", small_scene(64));
  ASSERT_EQ(
      run_program({"bake", path("scene.json"), "-o", path("a.bake"), "--reference=640"}).status, 0);
  const ProgramResult result =
      run_program({"report", "error-vs-time", path("a.bake"), "--frames", "3", "--policy", "nwa@30",
                   "--policy", "benefit@bytes:nwa@30", "-o", path("report"), "--json"});
  ASSERT_EQ(result.status, 0) << result.errors;
  const json report = json::parse(result.output);
  EXPECT_EQ(report.at("experiment"), "error-vs-time");
  EXPECT_EQ(report.at("reference"), "uncompressed");
  EXPECT_GT(report.at("receivers").get<int>(), 300);
  EXPECT_EQ(report.at("rows").size(), 2u * 3);
  EXPECT_EQ(report.at("rows")[0].at("light"), "studio");
  EXPECT_EQ(report, json::parse(read_file(folder_ / "report" / "error-vs-time.json", kMostBytes)));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "report" / "image-error-studio.gp"));

  EXPECT_EQ(run_program({"report"}).status, 2);
  EXPECT_EQ(run_program({"report", "error-vs-time"}).status, 2);
  const ProgramResult bad = run_program(
      {"report", "error-vs-time", path("a.bake"), "--policy", "paint@30", "-o", path("none")});
  EXPECT_EQ(bad.status, 1);
  EXPECT_THAT(bad.errors, HasSubstr("--policy: found \"paint"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none"));
}

TEST_F(Program, ReportsOnASceneThatItBakesFirst) {
  write(folder_ / "scene.json", small_scene(32));
  const ProgramResult result = run_program(
      {"report", "storage", "--scene", path("scene.json"), "-o", path("report"), "--json"});
  ASSERT_EQ(result.status, 0) << result.errors;
  const json report = json::parse(result.output);
  EXPECT_EQ(report.at("experiment"), "storage");
  EXPECT_GT(report.at("bake_over_csr").get<double>(), 0);
  EXPECT_EQ(report, json::parse(read_file(folder_ / "report" / "storage.json", kMostBytes)));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "report" / "storage.csv"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "report" / "scene.bake" / "manifest.json"));

  bake_scene();  // without reference rows
  const ProgramResult without = run_program({"report", "storage", path("a.bake")});
  EXPECT_EQ(without.status, 1);
  EXPECT_THAT(without.errors, HasSubstr("--reference"));
}

TEST_F(Program, ReportsOnEditsOfCurves) {
  write(folder_ / "balls.json", R"({ "name": "balls",
    "camera": { "position": [0, 1.2, 3.4], "target": [0, 0.4, 0], "field_of_view": 32 },
    "materials": { "pearl": { "model": "cook_torrance", "roughness": 0.3 } },
    "objects": [ { "shape": "sphere", "radius": 0.5, "material": "pearl" } ],
    "environments": ["studio", "cathedral"],
    "bake": { "kind": "brdf_curve", "width": 32, "height": 32, "cube_size": 8, "bounces": 0,
              "primary_rays": 4, "psnr_db": 30 } })");
  write(folder_ / "session.json", R"({ "edits": [ { "material": "pearl", "axis": "half_angle",
    "points": [[0, 9], [0.5, 1], [1, 0]], "rest": 2 } ] })");
  const ProgramResult result = run_program(
      {"report", "brdf-edit", path("balls.json"), "--session", path("session.json"), "--light",
       "cathedral", "--policy", "bi@256", "--policy", "nwa@2", "-o", path("report"), "--json"});
  ASSERT_EQ(result.status, 0) << result.errors;
  const json report = json::parse(result.output);
  EXPECT_EQ(report.at("experiment"), "brdf-edit");
  EXPECT_EQ(report.at("session"), "session");
  ASSERT_EQ(report.at("rows").size(), 2u * 3);
  EXPECT_EQ(report.at("rows")[0].at("run"), "bi@256");
  EXPECT_EQ(report.at("rows")[0].at("light"), "cathedral");
  EXPECT_LT(report.at("rows")[0].at("error_l2").get<double>(), 1e-5);
  EXPECT_GT(report.at("rows")[3].at("error_l2").get<double>(), 1e-3);
  EXPECT_EQ(report.at("stale").size(), 2u + 3 + 1);
  EXPECT_EQ(report, json::parse(read_file(folder_ / "report" / "brdf-edit.json", kMostBytes)));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "report" / "brdf-edit.csv"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "report" / "brdf-edit-error-vs-terms.gp"));

  // The pearl is there, cloth and posts of the built-in session are not.
  const ProgramResult bad =
      run_program({"report", "brdf-edit", path("report/balls.bake"), "-o", path("none")});
  EXPECT_EQ(bad.status, 1);
  EXPECT_THAT(bad.errors, HasSubstr("found the material \"cloth\""));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none"));
}

TEST_F(Program, ReportsOnVerticesWithoutABake) {
  const ProgramResult result =
      run_program({"report", "adaptive-sh", "--mesh", "orange", "--light", "studio", "--degree",
                   "3", "-o", path("report"), "--json"});
  ASSERT_EQ(result.status, 0) << result.errors;
  const json report = json::parse(result.output);
  EXPECT_EQ(report.at("experiment"), "adaptive-sh");
  ASSERT_EQ(report.at("rows").size(), 2u);
  EXPECT_EQ(report.at("rows")[1].at("mesh"), "orange");
  EXPECT_EQ(report.at("rows")[1].at("coefficients"), 16);
  EXPECT_GT(report.at("rows")[1].at("psnr_db").get<double>(), 40);
  EXPECT_EQ(report, json::parse(read_file(folder_ / "report" / "adaptive-sh.json", kMostBytes)));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "report" / "adaptive-sh-orange-studio.gp"));

  const ProgramResult bad = run_program({"report", "adaptive-sh", "--mesh", "teapot"});
  EXPECT_EQ(bad.status, 1);
  EXPECT_THAT(bad.errors, HasSubstr("--mesh: found \"teapot\""));
  EXPECT_EQ(run_program({"report", "adaptive-sh", "--degree", "40"}).status, 2);
}

TEST_F(Program, ABakeKeepsTheErrorAskedFor) {
  write(folder_ / "scene.json", small_scene(32));
  double bytes = 0;
  for (const char* const psnr : {"40", "60"}) {
    const ProgramResult result = run_program(
        {"bake", path("scene.json"), "-o", path("asked.bake"), "--psnr", psnr, "--json"});
    ASSERT_EQ(result.status, 0) << result.errors;
    const json summary = json::parse(result.output);
    EXPECT_GE(summary.at("worst_psnr_db").get<double>(), std::stod(psnr));
    EXPECT_GT(summary.at("transport_bytes").get<double>(), 1.2 * bytes);
    bytes = summary.at("transport_bytes").get<double>();
  }
  for (const char* const bad : {"nan", "inf", "19.9", "50dB"}) {
    const ProgramResult result =
        run_program({"bake", path("scene.json"), "-o", path("bad.bake"), "--psnr", bad});
    EXPECT_EQ(result.status, 2) << bad;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "bad.bake")) << bad;
  }
}

TEST_F(Program, ADamagedBakeIsRefusedByEveryCommand) {
  bake_scene();
  const auto file = folder_ / "a.bake" / "transport.safetensors";
  std::string bytes = read_file(file, kMostBytes);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 4);
  write(file, bytes);
  const std::vector<std::vector<std::string>> commands = {
      {"inspect", path("a.bake")},
      {"render", path("a.bake"), "-o", path("x.png")},
      {"serve", path("a.bake"), "--port", "0"}};
  for (const auto& command : commands) {
    const ProgramResult result = run_program(command);
    EXPECT_EQ(result.status, 1) << command[0];
    EXPECT_THAT(result.errors, HasSubstr("transport.safetensors")) << command[0];
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x.png"));
}

TEST_F(Program, ABakeThatWasKilledResumesToTheSameBytes) {
  write(folder_ / "wide.json", small_scene(256, 16));
  ASSERT_EQ(run_program({"bake", path("wide.json"), "-o", path("whole.bake")}).status, 0);
  {
    test::RunningProgram baking({"bake", path("wide.json"), "-o", path("killed.bake")});
    const auto first_tile_done = folder_ / "killed.bake.partial" / "tiles" / "tile-1.sums.json";
    while (baking.is_running() && !std::filesystem::exists(first_tile_done)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ASSERT_TRUE(baking.is_running()) << "it ended before it could be killed";
    baking.kill();
    EXPECT_EQ(baking.wait().status, 128 + 9);
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "killed.bake"));
  const ProgramResult resumed =
      run_program({"bake", path("wide.json"), "-o", path("killed.bake"), "--json"});
  ASSERT_EQ(resumed.status, 0) << resumed.errors;
  EXPECT_GE(json::parse(resumed.output).at("resumed_tiles").get<int>(), 1);
  for (const char* file : {"transport.safetensors", "pixels.safetensors", "manifest.json"}) {
    EXPECT_EQ(read_file(folder_ / "whole.bake" / file, kMostBytes),
              read_file(folder_ / "killed.bake" / file, kMostBytes))
        << file;
  }
}

}  // namespace
}  // namespace rimlight
