// Real meshes under a real probe, end to end: skipped where there are none (see RIMLIGHT_DATA).
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "core/image/image_file.h"
#include "tests/support/program.h"
#include "tests/support/real_data.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using nlohmann::json;
using test::run_program;

class RealData : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto data = test::real_data();
    if (!data) GTEST_SKIP() << "RIMLIGHT_DATA names no real data";
    data_ = *data;
  }

  /// Bakes a scene of one mesh at 64×64 and renders it under Grace Cathedral, as linear radiance.
  RgbImage relight(const json& camera, json object, bool with_floor) {
    json scene = {{"name", "real"},
                  {"camera", camera},
                  {"materials", {{"clay", {{"model", "lambert"}, {"albedo", {0.6, 0.6, 0.6}}}}}},
                  {"environments",
                   {{{"file", (data_ / "probes/grace_probe.hdr").string()},
                     {"layout", "angular_map"},
                     {"name", "grace"}}}},
                  {"bake",
                   {{"width", 64},
                    {"height", 64},
                    {"cube_size", 16},
                    {"primary_rays", 4},
                    {"bounces", 2},
                    {"psnr_db", 40}}}};
    object["file"] = (data_ / object["file"].get<std::string>()).string();
    scene["objects"].push_back(object);
    if (with_floor) {
      scene["objects"].push_back({{"shape", "plane"}, {"size", {6, 6}}, {"material", "clay"}});
    }
    std::ofstream(folder_ / "scene.json") << scene.dump();
    const auto path = [this](const char* name) { return (folder_ / name).string(); };
    const auto baked = run_program({"bake", path("scene.json"), "-o", path("a.bake"), "--json"});
    EXPECT_EQ(baked.status, 0) << baked.errors;
    EXPECT_GE(json::parse(baked.output).at("worst_psnr_db").get<double>(), 40);
    const auto rendered =
        run_program({"render", path("a.bake"), "--light", "grace", "-o", path("a.exr")});
    EXPECT_EQ(rendered.status, 0) << rendered.errors;
    return read_radiance(folder_ / "a.exr");
  }

  std::filesystem::path data_;
  test::TemporaryFolder folder_;
};

/// The mean luminance of a part of a picture.
double mean(const RgbImage& image, int left, int top, int right, int bottom) {
  double sum = 0;
  for (int y = top; y < bottom; ++y) {
    for (int x = left; x < right; ++x) {
      const Vec3f& pixel = image.at(x, y);
      EXPECT_TRUE(std::isfinite(pixel.x) && std::isfinite(pixel.y) && std::isfinite(pixel.z));
      sum += static_cast<double>(pixel.x + pixel.y + pixel.z) / 3;
    }
  }
  return sum / ((right - left) * (bottom - top));
}

TEST_F(RealData, TheBunnyIsLitByGraceCathedralFromAbove) {
  const RgbImage image =
      relight({{"position", {0.3, 1.1, 2.4}}, {"target", {0, 0.45, 0}}, {"field_of_view", 34}},
              {{"file", "meshes/bunny.obj"}, {"material", "clay"}, {"fit", {{"height", 1}}}}, true);
  EXPECT_GT(mean(image, 24, 24, 40, 40), 0.01) << "the bunny's body";
  // The floor faces the bright windows above, the body's side does not.
  EXPECT_GT(mean(image, 4, 50, 16, 60), mean(image, 24, 34, 40, 44));
}

TEST_F(RealData, TheCornellBoxIsLitThroughItsOpening) {
  const RgbImage image =
      relight({{"position", {0, 1, 3.6}}, {"target", {0, 1, 0}}, {"field_of_view", 38}},
              {{"file", "scenes/cornellBox/cornellBox.gltf"}, {"fit", {{"height", 2}}}}, false);
  EXPECT_GT(mean(image, 16, 16, 48, 48), 1e-3);
  EXPECT_LT(mean(image, 16, 16, 48, 48), 50);
}

}  // namespace
}  // namespace rimlight
