// Whole bakes of kind brdf_curve, from scene to folder.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>

#include "core/bake/image_bake.h"
#include "core/base/files.h"
#include "core/base/parallel.h"
#include "core/scene/shapes.h"
#include "core/transport/bake_folder.h"
#include "tests/core/bake/bake_scenes.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using test::error_of;
using test::TemporaryFolder;
using ::testing::HasSubstr;

/// A grey sky with a window.
Environment sky(const std::string& name, const Vec3f& window) {
  RgbImage image(16, 8);
  std::ranges::fill(image.pixels, Vec3f{0.2f, 0.2f, 0.3f});
  image.at(9, 2) = window;
  return Environment(name, std::move(image), EnvironmentLayout::lat_long);
}

/// A metal ball on a floor; two tiles across.
std::shared_ptr<Scene> ball_scene() {
  auto scene = std::make_shared<Scene>();
  scene->name = "ball";
  scene->camera.position = {0.5, 1.5, 4};
  scene->camera.vertical_field_of_view_degrees = 35;
  scene->materials = {metal(0.3f), lambert(0.6f)};
  scene->meshes = {make_sphere(0.7, 24), quad({-3, -0.7f, -3}, {0, 0, 6}, {6, 0, 0}, 1)};
  scene->environments = {sky("clear", {9, 8, 6}), sky("dim", {0.5f, 0.4f, 0.3f})};
  scene->bake.kind = BakeKind::brdf_curve;
  scene->bake.width = 72;
  scene->bake.height = 24;
  scene->bake.cube_size = 8;
  scene->bake.primary_rays = 2;
  scene->bake.bounces = 1;
  scene->bake.psnr_db = 45;
  return scene;
}

std::map<std::string, std::string> contents(const std::filesystem::path& folder) {
  std::map<std::string, std::string> result;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    result[entry.path().filename().string()] = read_file(entry.path(), std::size_t{1} << 30);
  }
  return result;
}

TEST(CurveBakeOfAScene, HoldsItsMaterialsAndLessTransport) {
  const TemporaryFolder folder;
  const auto scene = ball_scene();
  const BakeSummary summary = bake_curves(scene, folder / "a.bake", {});
  const BakeSummary image = bake_image(scene, folder / "image.bake", {});
  EXPECT_GE(summary.worst_psnr_db, 45);
  EXPECT_LT(summary.bytes, image.bytes);
  const Bake bake(folder / "a.bake");
  bake.verify();
  ASSERT_TRUE(bake.has_curves());
  ASSERT_EQ(bake.manifest().materials.size(), 1u);
  EXPECT_EQ(bake.manifest().materials[0].name, "metal");
  EXPECT_EQ(bake.manifest().materials[0].brdf.eta, scene->materials[0].brdf.eta);
  EXPECT_GT(bake.curve_receivers().surfaces.size(), 100u);
  // A picture is as bright as it was, with what is not in the transport.
  const Bake whole(folder / "image.bake");
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(bake.environments()[i].exposure_scale / whole.environments()[i].exposure_scale, 1,
                0.02);
  }
}

TEST(CurveBakeOfAScene, MayBeOfEditableMaterialsAlone) {
  const TemporaryFolder folder;
  const auto scene = ball_scene();
  scene->bake.bounces = 0;
  scene->bake.editable = {"metal", "lambert"};
  const BakeSummary summary = bake_curves(scene, folder / "a.bake", {});
  EXPECT_EQ(summary.bytes, 0u);
  const Bake bake(folder / "a.bake");
  bake.verify();
  EXPECT_EQ(bake.manifest().materials.size(), 2u);
  for (const auto& one : bake.environments()) EXPECT_GT(one.exposure_scale, 0);
}

TEST(CurveBakeOfAScene, TheBytesDoNotDependOnThreads) {
  const TemporaryFolder folder;
  for (const int threads : {1, 3}) {
    set_thread_count(threads);
    bake_curves(ball_scene(), folder / (std::to_string(threads) + ".bake"), {});
  }
  set_thread_count(0);
  const auto one = contents(folder / "1.bake");
  EXPECT_TRUE(one.contains(kCurvesFile));
  EXPECT_EQ(one, contents(folder / "3.bake"));
}

TEST(CurveBakeOfAScene, ResumesAfterAnInterruptionButNotOfOtherMaterials) {
  const TemporaryFolder folder;
  bake_curves(ball_scene(), folder / "whole.bake", {});
  const auto interrupt = [](const BakeProgress& progress) {
    if (progress.stage == "tracing" && progress.fraction > 0) throw std::runtime_error("stop");
  };
  EXPECT_THROW(bake_curves(ball_scene(), folder / "a.bake", interrupt), std::runtime_error);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.bake"));
  const BakeSummary resumed = bake_curves(ball_scene(), folder / "a.bake", {});
  EXPECT_EQ(resumed.resumed_tiles, 1u);
  EXPECT_EQ(contents(folder / "whole.bake"), contents(folder / "a.bake"));
  EXPECT_THROW(bake_curves(ball_scene(), folder / "b.bake", interrupt), std::runtime_error);
  const auto other = ball_scene();
  other->bake.editable = {"lambert"};
  EXPECT_EQ(bake_curves(other, folder / "b.bake", {}).resumed_tiles, 0u);
}

TEST(CurveBakeOfAScene, WithNothingToEditIsAnErrorAndLeavesNothing) {
  const TemporaryFolder folder;
  const auto scene = ball_scene();
  scene->bake.editable = {"brass"};
  EXPECT_THAT(error_of([&] { bake_curves(scene, folder / "a.bake", {}); }), HasSubstr("brass"));
  const auto away = ball_scene();
  away->camera.target = {100, 100, 100};
  EXPECT_THAT(error_of([&] { bake_curves(away, folder / "a.bake", {}); }),
              HasSubstr("in the picture"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.bake"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.bake.partial"));
}

}  // namespace
}  // namespace rimlight
