// rimlight import from outside: a matrix and a light stage made from a bake of our own, imported,
// inspected, rendered and served.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "core/base/files.h"
#include "core/basis/cube_map.h"
#include "core/image/image_file.h"
#include "core/image/metrics.h"
#include "core/math/random.h"
#include "core/transport/bake_folder.h"
#include "tests/core/import/npy_bytes.h"
#include "tests/support/dense_transport.h"
#include "tests/support/overwrite.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using nlohmann::json;
using test::ProgramResult;
using test::run_program;
using ::testing::HasSubstr;

constexpr int kSide = 64;

/// A ball on a floor that fills the picture.
constexpr const char* kScene = R"({ "name": "ball",
  "camera": { "position": [0, 3, 2.5], "target": [0, 0.3, 0], "field_of_view": 30 },
  "materials": { "clay": { "model": "lambert", "albedo": [0.7, 0.5, 0.4] } },
  "objects": [ { "shape": "sphere", "radius": 0.6, "translate": [0, 0.6, 0], "material": "clay" },
               { "shape": "plane", "size": [12, 12], "material": "clay" } ],
  "environments": ["studio"],
  "bake": { "width": 64, "height": 64, "cube_size": 8, "bounces": 1, "psnr_db": 55,
            "primary_rays": 4 } })";

/// A strip of cube faces, size × size each, one texel of cube::texel_direction a pixel.
RgbImage cube_strip(int size, const std::function<Vec3f(std::size_t)>& radiance) {
  RgbImage image(6 * size, size);
  for (std::size_t texel = 0; texel < cube::texel_count(size); ++texel) {
    const Vec3d d = cube::texel_direction(texel, size);
    // Each face seen from inside: right and up as EnvironmentLayout gives them.
    const cube::FacePoint point = cube::face_point(d);
    const Vec3d right[6] = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {1, 0, 0}, {-1, 0, 0}, {1, 0, 0}};
    const Vec3d up[6] = {{0, 1, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}, {0, 1, 0}, {0, 1, 0}};
    const double depth = std::abs(dot(d, cube::face_axes(point.face).axis));
    const double s = dot(d, right[point.face]) / depth, t = dot(d, up[point.face]) / depth;
    image.at(point.face * size + static_cast<int>((s + 1) / 2 * size),
             static_cast<int>((1 - t) / 2 * size)) = radiance(texel);
  }
  return image;
}

class ImportCommand : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  void bake_scene() {
    test::overwrite(folder_ / "scene.json", kScene);
    run({"bake", path("scene.json"), "-o", path("own.bake")});
  }

  /// Runs it and expects it to end well; its standard output.
  std::string run(const std::vector<std::string>& arguments) {
    const ProgramResult result = run_program(arguments);
    EXPECT_EQ(result.status, 0) << result.errors;
    return result.output;
  }

  RgbImage render(const std::string& bake, const std::string& light,
                  const std::string& rotation = "0,0,0,1") {
    run({"render", path(bake), "--light", light, "--rotation", rotation, "-o", path("x.exr")});
    return read_radiance(folder_ / "x.exr");
  }

  double psnr(const std::string& light, const std::string& rotation) {
    const RgbImage expected = render("own.bake", light, rotation);
    const RgbImage image = render("import.bake", light, rotation);
    return display_psnr(image.pixels, expected.pixels, auto_exposure_scale(expected.pixels));
  }

  test::TemporaryFolder folder_;
};

TEST_F(ImportCommand, AMatrixOfOurOwnBakeRendersAsTheBake) {
  bake_scene();
  // As lamps: densities per steradian, and the solid angle of each texel for its weight.
  std::vector<float> matrix = test::dense_transport(Bake(folder_ / "own.bake"));
  const std::size_t texels = cube::texel_count(8);
  std::vector<float> lights;
  for (std::size_t texel = 0; texel < texels; ++texel) {
    const Vec3f d(cube::texel_direction(texel, 8) * 3);
    const auto weight = static_cast<float>(cube::texel_solid_angle(texel, 8));
    // Written z up: the world's (x, y, z) is (x, −z, y) there.
    lights.insert(lights.end(), {d.x, -d.z, d.y, weight});
    for (std::size_t i = 3 * texel; i < matrix.size(); i += 3 * texels) {
      for (std::size_t c = 0; c < 3; ++c) matrix[i + c] /= weight;
    }
  }
  test::overwrite(folder_ / "m.npy", npy_floats({kSide * kSide, texels, 3}, matrix));
  test::overwrite(folder_ / "lights.npy", npy_floats({texels, 4}, lights));
  const json summary =
      json::parse(run({"import", path("m.npy"), "--directions", path("lights.npy"), "--axes",
                       "z_up", "--width", "64", "--height", "64", "--cube-size", "8", "--psnr",
                       "55", "-o", path("import.bake"), "--json"}));
  EXPECT_EQ(summary.at("directions"), texels);
  EXPECT_NEAR(summary.at("weight_sum").get<double>(), 12.566, 0.001);
  EXPECT_GE(summary.at("worst_psnr_db").get<double>(), 55);
  EXPECT_GT(summary.at("resampling").at("studio").at("psnr_db").get<double>(), 40);

  const json bake = json::parse(run({"inspect", path("import.bake"), "--verify", "--json"}));
  EXPECT_EQ(bake.at("scene"), "m");
  EXPECT_EQ(bake.at("columns"), texels);
  EXPECT_EQ(bake.at("settings").at("weights"), "given");
  EXPECT_EQ(bake.at("environments").size(), 3u);
  EXPECT_EQ(
      bake.at("measured").at("resampling").at("studio").at("psnr_db"),
      std::round(summary.at("resampling").at("studio").at("psnr_db").get<double>() * 100) / 100);
  for (const char* rotation : {"0,0,0,1", "0,0.6,0,0.8", "0.5,0.5,-0.5,0.5"}) {
    const double studio = psnr("studio", rotation);
    std::printf("studio at %s: %.1f dB\n", rotation, studio);
    EXPECT_GT(studio, 42) << rotation;
  }
}

TEST_F(ImportCommand, PicturesUnderOneFaceEachRenderAsTheBake) {
  bake_scene();
  // Environments of one texel a face, one of them lit: the Voronoi cells of the six axes are the
  // faces, so that nothing is lost but what compression costs.
  constexpr std::size_t kLights = 6;
  std::filesystem::create_directory(folder_ / "stage");
  std::string list = "# right-handed, y up\n";
  for (std::size_t light = 0; light < kLights; ++light) {
    write_exr(folder_ / "light.exr", cube_strip(1, [light](std::size_t texel) {
                return Vec3f::filled(texel == light ? 1.0f : 0.0f);
              }));
    run({"render", path("own.bake"), "--light", path("light.exr"), "-o",
         path("stage/" + std::to_string(light) + ".exr")});
    const Vec3d d = cube::texel_direction(light, 1);
    list += std::to_string(d.x) + " " + std::to_string(d.y) + " " + std::to_string(d.z) + "\n";
  }
  test::overwrite(folder_ / "lights.txt", list);
  run({"import", path("stage"), "--directions", path("lights.txt"), "--unit", "radiance",
       "--environment", "studio", "--environment", "sunny", "-o", path("import.bake"), "--name",
       "ball"});
  const json bake = json::parse(run({"inspect", path("import.bake"), "--json"}));
  EXPECT_EQ(bake.at("width"), kSide);
  EXPECT_EQ(bake.at("cube_size"), 8);
  EXPECT_EQ(bake.at("environments").at(1).at("name"), "sunny");
  Random random(3);
  std::vector<Vec3f> colours;
  for (std::size_t i = 0; i < kLights; ++i) {
    colours.emplace_back(random.uniform_float(), random.uniform_float(), random.uniform_float());
  }
  write_exr(folder_ / "many.exr", cube_strip(1, [&](std::size_t texel) { return colours[texel]; }));
  const double many = psnr(path("many.exr"), "0,0,0,1");
  std::printf("many lights: %.1f dB\n", many);
  EXPECT_GT(many, 45);
}

TEST_F(ImportCommand, AnImportedBakeIsServed) {
  constexpr std::size_t kLights = 24;
  Random random(5);
  std::vector<float> matrix;
  for (std::size_t i = 0; i < 16 * 16 * kLights; ++i) matrix.push_back(random.uniform_float());
  std::string list;
  for (std::size_t i = 0; i < kLights; ++i) {
    const Vec3d d = cube::texel_direction(i, 2);
    list += std::to_string(d.x) + "," + std::to_string(d.y) + "," + std::to_string(d.z) + "\n";
  }
  test::overwrite(folder_ / "m.npy", npy_floats({16 * 16, kLights}, matrix));
  test::overwrite(folder_ / "lights.csv", list);
  run({"import", path("m.npy"), "-d", path("lights.csv"), "--width", "16", "--height", "16", "-o",
       path("import.bake")});
  test::RunningProgram server({"serve", path("import.bake"), "--port", "0", "--json"});
  std::string address;
  while (address.empty() && server.is_running()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const std::string output = server.output();
    if (output.ends_with('\n')) address = json::parse(output).at("address").get<std::string>();
  }
  ASSERT_TRUE(address.starts_with("http://")) << address;
  const ProgramResult load =
      run_program({"load", "--url", "ws://" + address.substr(7, address.size() - 8), "--seconds",
                   "0.5", "--bake", path("import.bake"), "--json"});
  EXPECT_EQ(load.status, 0) << load.output << load.errors;
}

TEST_F(ImportCommand, MistakesAreNamedAndLeaveNothing) {
  test::overwrite(folder_ / "m.npy", npy_floats({6, 2}, std::vector<float>(12, 0.5f)));
  test::overwrite(folder_ / "two.txt", "0 1 0\n0 -1 0\n");
  test::overwrite(folder_ / "three.txt", "0 1 0\n0 -1 0\n1 0 0\n");
  std::filesystem::create_directory(folder_ / "stage");
  write_exr(folder_ / "stage/a.exr", RgbImage(4, 4));
  write_exr(folder_ / "stage/b.exr", RgbImage(4, 5));
  struct Case {
    std::vector<std::string> arguments;
    std::string expected;
  };
  const std::string matrix = path("m.npy"), stage = path("stage");
  const std::string two = path("two.txt"), three = path("three.txt");
  for (const Case& one :
       {Case{{matrix, "-d", two}, "--width, --height"},
        Case{{matrix, "-d", two, "--width", "5", "--height", "2"}, "found 6 receivers"},
        Case{{matrix, "-d", three, "--width", "3", "--height", "2"}, "three.txt: found 3 dir"},
        Case{{matrix, "-d", path("none.txt"), "--width", "3", "--height", "2"}, "none.txt"},
        Case{{matrix, "-d", two, "--width", "3", "--height", "2", "--cap", "0,1,0,90"}, "180 deg"},
        Case{{matrix, "-d", two, "--width", "3", "--height", "2", "--cap", "0,0,0,9"}, "--cap"},
        Case{{matrix, "-d", two, "--width", "3", "--height", "2", "--environment", "moon"}, "moon"},
        Case{{matrix, "-d", two, "--width", "3", "--height", "2", "--camera-position", "0,9,0"},
             "--camera-position"},
        Case{{stage, "-d", two, "--width", "4"}, "--width"},
        Case{{stage, "-d", three}, "found 2 pictures, expected 3"},
        Case{{stage, "-d", two}, "b.exr: found 4 × 5 pixels"}}) {
    std::vector<std::string> arguments = {"import", "-o", path("a.bake")};
    arguments.insert(arguments.end(), one.arguments.begin(), one.arguments.end());
    const ProgramResult result = run_program(arguments);
    EXPECT_EQ(result.status, 1) << one.expected;
    EXPECT_THAT(result.errors, HasSubstr(one.expected));
    EXPECT_EQ(result.output, "");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "a.bake"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "a.bake.partial"));
  }
  EXPECT_EQ(run_program({"import"}).status, 2);
  EXPECT_EQ(run_program({"import", matrix}).status, 2);
  EXPECT_EQ(run_program({"import", matrix, "-d", two, "--unit", "lux"}).status, 2);
}

TEST_F(ImportCommand, SaysWhatLooksLikeAMistake) {
  // A cap of lights, of which the outer ones would stand for the whole sphere beside and below it.
  test::overwrite(folder_ / "m.npy", npy_floats({6, 49}, std::vector<float>(6 * 49, 0.5f)));
  std::string lights;
  for (int i = 0; i < 49; ++i) {
    lights += std::to_string(0.1 * (i % 7 - 3)) + " 1 " + std::to_string(0.1 * (i / 7 - 3)) + "\n";
  }
  test::overwrite(folder_ / "lights.txt", lights);
  const ProgramResult result = run_program({"import", path("m.npy"), "-d", path("lights.txt"),
                                            "--width", "3", "--height", "2", "-o", path("a.bake")});
  EXPECT_EQ(result.status, 0) << result.errors;
  EXPECT_THAT(result.errors, HasSubstr(" sr, the median for 0.0"));
  EXPECT_THAT(result.errors, HasSubstr("--cap"));
  EXPECT_THAT(result.errors, HasSubstr("resampling: sunny"));
}

}  // namespace
}  // namespace rimlight
