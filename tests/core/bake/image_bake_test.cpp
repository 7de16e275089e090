// A whole bake, from scene to folder: error kept, bytes the same whatever the threads or
// interruptions.
#include <gtest/gtest.h>

#include <map>
#include <stdexcept>
#include <string>

#include "core/bake/image_bake.h"
#include "core/base/error.h"
#include "core/base/files.h"
#include "core/base/parallel.h"
#include "core/transport/bake_folder.h"
#include "tests/core/bake/bake_scenes.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

/// Two tiles across, so that there is something to resume.
std::shared_ptr<Scene> small_scene() {
  auto scene = corner_scene(lambert(0.6f));
  scene->bake.width = 128;
  scene->bake.height = 64;
  scene->bake.cube_size = 8;
  scene->bake.primary_rays = 4;
  scene->bake.bounces = 1;
  scene->bake.psnr_db = 45;
  scene->environments = {builtin_environment("sunny"), builtin_environment("studio")};
  return scene;
}

std::map<std::string, std::string> contents(const std::filesystem::path& folder) {
  std::map<std::string, std::string> result;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    result[entry.path().filename().string()] = read_file(entry.path(), std::size_t{1} << 30);
  }
  return result;
}

TEST(ImageBake, KeepsTheErrorAskedForAndOpens) {
  const test::TemporaryFolder folder;
  const auto scene = small_scene();
  const BakeSummary summary = bake_image(scene, folder / "a.bake", {});
  EXPECT_GE(summary.worst_psnr_db, 45);
  EXPECT_GT(summary.bytes, 10'000u);
  const Bake bake(folder / "a.bake");
  bake.verify();
  EXPECT_EQ(bake.transport().byte_count(), summary.bytes);
  EXPECT_EQ(bake.manifest().pixels.width, 128);
  EXPECT_EQ(bake.manifest().cube_size, 8);
  ASSERT_EQ(bake.environments().size(), 2u);
  for (const auto& one : bake.environments()) EXPECT_GT(one.exposure_scale, 0);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.bake.partial"));
}

TEST(ImageBake, LessErrorAskedForKeepsMore) {
  const test::TemporaryFolder folder;
  const auto coarse = small_scene();
  coarse->bake.psnr_db = 35;
  const auto fine = small_scene();
  fine->bake.psnr_db = 55;
  const BakeSummary few = bake_image(coarse, folder / "coarse.bake", {});
  const BakeSummary many = bake_image(fine, folder / "fine.bake", {});
  EXPECT_LT(few.bytes, many.bytes);
  EXPECT_GE(few.worst_psnr_db, 35);
  EXPECT_GE(many.worst_psnr_db, 55);
}

TEST(ImageBake, TheBytesDoNotDependOnThreads) {
  const test::TemporaryFolder folder;
  bake_image(small_scene(), folder / "all.bake", {});
  set_thread_count(1);
  bake_image(small_scene(), folder / "one.bake", {});
  set_thread_count(3);
  bake_image(small_scene(), folder / "three.bake", {});
  set_thread_count(0);
  const auto all = contents(folder / "all.bake");
  ASSERT_GE(all.size(), 4u);
  EXPECT_EQ(all, contents(folder / "one.bake"));
  EXPECT_EQ(all, contents(folder / "three.bake"));
}

TEST(ImageBake, AnInterruptedBakeResumesToTheSameBytes) {
  const test::TemporaryFolder folder;
  bake_image(small_scene(), folder / "whole.bake", {});
  const auto interrupt = [](const BakeProgress& progress) {
    if (progress.stage == "tracing" && progress.fraction > 0) throw std::runtime_error("stop");
  };
  EXPECT_THROW(bake_image(small_scene(), folder / "a.bake", interrupt), std::runtime_error);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.bake"));
  const BakeSummary resumed = bake_image(small_scene(), folder / "a.bake", {});
  EXPECT_EQ(resumed.resumed_tiles, 1u);
  EXPECT_EQ(contents(folder / "whole.bake"), contents(folder / "a.bake"));
}

TEST(ImageBake, PartsOfAnotherSceneAreNotResumed) {
  const test::TemporaryFolder folder;
  const auto interrupt = [](const BakeProgress& progress) {
    if (progress.stage == "tracing" && progress.fraction > 0) throw std::runtime_error("stop");
  };
  EXPECT_THROW(bake_image(small_scene(), folder / "a.bake", interrupt), std::runtime_error);
  const auto other = small_scene();
  other->materials[0].brdf.albedo.x = 0.61f;
  EXPECT_EQ(bake_image(other, folder / "a.bake", {}).resumed_tiles, 0u);
}

TEST(ImageBake, ACameraThatSeesNothingIsAnError) {
  const test::TemporaryFolder folder;
  const auto scene = small_scene();
  scene->camera.target = {100, 100, 100};
  EXPECT_THROW(bake_image(scene, folder / "a.bake", {}), Error);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.bake"));
}

}  // namespace
}  // namespace rimlight
