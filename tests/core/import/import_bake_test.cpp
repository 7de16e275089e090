// Whole imports, from transport to a bake that renders.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>

#include "core/bake/image_bake.h"
#include "core/base/files.h"
#include "core/base/parallel.h"
#include "core/image/metrics.h"
#include "core/import/import_bake.h"
#include "core/import/matrix_source.h"
#include "core/relight/frame_renderer.h"
#include "tests/core/bake/bake_scenes.h"
#include "tests/core/import/ball_source.h"
#include "tests/core/import/direction_sets.h"
#include "tests/core/import/npy_bytes.h"
#include "tests/support/dense_transport.h"
#include "tests/support/error_of.h"
#include "tests/support/overwrite.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using ::testing::HasSubstr;

DirectionList list_of(std::vector<Vec3d> directions) {
  DirectionList list;
  list.source = "lights.txt";
  list.directions = std::move(directions);
  return list;
}

ImportSettings small_settings() {
  ImportSettings settings;
  settings.name = "ball";
  settings.cube_size = 8;
  settings.environments = {builtin_environment("studio")};
  return settings;
}

MakeSource ball(const DirectionList& list, int width = 40, int height = 24) {
  return [=](const std::filesystem::path&) {
    return std::make_unique<BallSource>(list.directions, width, height);
  };
}

RgbImage render(const std::filesystem::path& folder, const Environment& environment) {
  FrameRenderer renderer(std::make_shared<const Bake>(folder), {});
  renderer.add_environment(std::make_shared<const Environment>(environment));
  RgbImage image;
  FrameReport report;
  renderer.render_radiance({environment.name(), Quaternion{}, 0}, image, report);
  return image;
}

Environment uniform_environment(float radiance) {
  RgbImage image(16, 8);
  for (Vec3f& pixel : image.pixels) pixel = Vec3f::filled(radiance);
  return {"uniform", std::move(image)};
}

std::map<std::string, std::string> contents(const std::filesystem::path& folder) {
  std::map<std::string, std::string> result;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    result[entry.path().filename().string()] = read_file(entry.path(), std::size_t{1} << 30);
  }
  return result;
}

class ImportBake : public ::testing::Test {
 protected:
  test::TemporaryFolder folder_;
};

TEST_F(ImportBake, ABallUnderAUniformSkyHasItsIrradianceByPi) {
  // Of radiance 1/π · E = 1 · (what the weights make of ∫ max(cos, 0) dω / π).
  const DirectionList list = list_of(random_directions(400, 1));
  const ImportSummary summary =
      import_bake(ball(list), list, small_settings(), folder_ / "a.bake", {});
  EXPECT_EQ(summary.directions, 400u);
  EXPECT_NEAR(summary.weight_sum, 4 * std::numbers::pi, 1e-9);
  EXPECT_NEAR(summary.covered, 4 * std::numbers::pi, 1e-12);
  EXPECT_GE(summary.worst_psnr_db, 50);
  EXPECT_EQ(summary.resampling.size(), 3u);
  const DirectionCells cells(list.directions, 1);
  const RgbImage image = render(folder_ / "a.bake", uniform_environment(2));
  const PixelLayout pixels{40, 24};
  std::size_t seen = 0;
  for (int y = 0; y < pixels.height; ++y) {
    for (int x = 0; x < pixels.width; ++x) {
      const Vec3d n = BallSource::normal(pixels, x, y);
      double expected = 0;
      for (std::size_t i = 0; i < list.size(); ++i) {
        expected +=
            2 * cells.solid_angle(i) * std::max(dot(n, list.directions[i]), 0.0) / std::numbers::pi;
      }
      if (expected > 0) {
        EXPECT_NEAR(expected, 2, 0.2);
      }
      EXPECT_NEAR(static_cast<double>(image.at(x, y).y), expected, 0.02);
      seen += expected > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(seen, 600u);
}

TEST_F(ImportBake, ABakeOfOurOwnComesBack) {
  const auto scene = corner_scene(lambert(0.6f));
  scene->bake.cube_size = 16;
  scene->bake.primary_rays = 4;
  scene->bake.bounces = 1;
  scene->bake.psnr_db = 55;
  scene->environments = {builtin_environment("studio")};
  bake_image(scene, folder_ / "own.bake", {});
  const Bake own(folder_ / "own.bake");
  const std::size_t texels = cube::texel_count(16);
  test::overwrite(folder_ / "m.npy", npy_floats({64 * 64, texels, 3}, test::dense_transport(own)));
  ImportSettings settings = small_settings();
  settings.unit = ColumnUnit::radiance;
  settings.cube_size = 16;
  settings.psnr_db = 55;
  settings.mask = CoverageMask{"own", 64, 64, own.coverage()};
  settings.camera = own.manifest().camera;
  const DirectionList list = list_of(texel_directions(16));
  const auto source = [&](const std::filesystem::path&) {
    return std::make_unique<MatrixSource>(folder_ / "m.npy", 64, 64);
  };
  const ImportSummary summary = import_bake(source, list, settings, folder_ / "import.bake", {});
  for (const ResamplingError& error : summary.resampling) {
    std::printf("%s: resampling %.1f dB, relative L2 %.4f\n", error.light.c_str(), error.psnr_db,
                error.relative_l2);
    EXPECT_GT(error.psnr_db, 40) << error.light;
  }
  for (const std::string& name : builtin_environment_names()) {
    const Environment environment = builtin_environment(name);
    const RgbImage expected = render(folder_ / "own.bake", environment);
    const RgbImage image = render(folder_ / "import.bake", environment);
    const double psnr =
        display_psnr(image.pixels, expected.pixels, auto_exposure_scale(expected.pixels));
    std::printf("%s: %.1f dB\n", name.c_str(), psnr);
    EXPECT_GT(psnr, 42) << name;
  }
}

TEST_F(ImportBake, GivenWeightsTakeThePlaceOfVoronoiAreas) {
  DirectionList list = list_of(random_directions(60, 2));
  const auto mean = [&](const char* name) {
    import_bake(ball(list), list, small_settings(), folder_ / name, {});
    const RgbImage image = render(folder_ / name, uniform_environment(1));
    return static_cast<double>(image.at(20, 12).x);
  };
  const double once = mean("once.bake");
  const DirectionCells cells(list.directions, 1);
  for (std::size_t i = 0; i < list.size(); ++i) list.weights.push_back(3 * cells.solid_angle(i));
  EXPECT_NEAR(mean("thrice.bake") / once, 3, 0.03);
}

TEST_F(ImportBake, ColumnsPerRadianceNeedNoWeights) {
  // The same columns, said to be integrals: a sum without weights.
  const DirectionList list = list_of(random_directions(60, 3));
  ImportSettings settings = small_settings();
  settings.unit = ColumnUnit::radiance;
  import_bake(ball(list), list, settings, folder_ / "a.bake", {});
  double expected = 0;
  const Vec3d normal = BallSource::normal({40, 24}, 20, 12);
  for (const Vec3d& one : list.directions) {
    expected += std::max(dot(normal, one), 0.0) / std::numbers::pi;
  }
  const RgbImage image = render(folder_ / "a.bake", uniform_environment(1));
  EXPECT_NEAR(static_cast<double>(image.at(20, 12).x) / expected, 1, 0.01);
}

TEST_F(ImportBake, BelowACapThereIsNoLight) {
  const DirectionList list = list_of(random_cap(200, {0, 1, 0}, std::numbers::pi / 2, 4));
  ImportSettings settings = small_settings();
  settings.cap = {{0, 1, 0}, std::numbers::pi / 2};
  const ImportSummary summary = import_bake(ball(list), list, settings, folder_ / "a.bake", {});
  EXPECT_NEAR(summary.weight_sum, 2 * std::numbers::pi, 1e-9);
  RgbImage below(16, 8);  // dark above the horizon
  for (int y = 4; y < 8; ++y) {
    for (int x = 0; x < 16; ++x) below.at(x, y) = {1, 1, 1};
  }
  const RgbImage dark = render(folder_ / "a.bake", {"below", std::move(below)});
  const RgbImage lit = render(folder_ / "a.bake", uniform_environment(1));
  EXPECT_LT(max_component(dark.at(20, 12)), 0.01f);
  EXPECT_GT(max_component(lit.at(20, 12)), 0.3f);

  const DirectionList outside = list_of(random_directions(20, 5));
  const std::string error = test::error_of(
      [&] { import_bake(ball(outside), outside, settings, folder_ / "b.bake", {}); });
  EXPECT_THAT(error, HasSubstr("lights.txt: direction "));
  EXPECT_THAT(error, HasSubstr("at most 90"));
}

TEST_F(ImportBake, WhatTheMaskLeavesOutIsTheEnvironment) {
  const DirectionList list = list_of(random_directions(50, 6));
  ImportSettings settings = small_settings();
  CoverageMask mask{"mask.png", 40, 24, std::vector<float>(40 * 24, 1.0f)};
  for (std::size_t i = 0; i < mask.shares.size(); ++i) {
    if (i % 40 < 20) mask.shares[i] = 0;
  }
  settings.mask = mask;
  import_bake(ball(list), list, settings, folder_ / "a.bake", {});
  const RgbImage image = render(folder_ / "a.bake", uniform_environment(5));
  EXPECT_NEAR(image.at(10, 12).x, 5, 1e-3);
  EXPECT_LT(image.at(21, 12).x, 5.5f);
  EXPECT_GT(image.at(21, 12).x, 4.0f);  // the ball's own: 5 ± the quadrature's error
  EXPECT_LT(image.at(39, 0).x, 1e-3f);  // covered, and black

  const auto error_of_mask = [&](int width, int height) {
    const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    settings.mask = CoverageMask{"mask.png", width, height, std::vector<float>(count)};
    return test::error_of([&] { import_bake(ball(list), list, settings, folder_ / "b.bake", {}); });
  };
  EXPECT_THAT(error_of_mask(40, 24), HasSubstr("mask.png: found a mask that covers nothing"));
  EXPECT_THAT(error_of_mask(24, 40), HasSubstr("mask.png: found 24 × 40 pixels, expected 40 × 24"));
}

TEST_F(ImportBake, TheManifestSaysWhatWasImportedAndItsError) {
  const DirectionList list = list_of(random_directions(30, 7));
  const ImportSummary summary =
      import_bake(ball(list), list, small_settings(), folder_ / "a.bake", {});
  const Bake bake(folder_ / "a.bake");
  bake.verify();
  const BakeManifest& manifest = bake.manifest();
  EXPECT_EQ(manifest.scene, "ball");
  EXPECT_EQ(manifest.pixels.width, 40);
  EXPECT_EQ(manifest.settings.at("directions"), 30);
  EXPECT_EQ(manifest.settings.at("weights"), "voronoi");
  for (const ResamplingError& error : summary.resampling) {
    EXPECT_NEAR(manifest.measured.at("resampling").at(error.light).at("psnr_db").get<double>(),
                error.psnr_db, 0.01);
  }
  EXPECT_EQ(bake.environments().size(), 1u);
  EXPECT_EQ(bake.transport().byte_count(), summary.bytes);
}

TEST_F(ImportBake, FinerCubeMapsResampleBetter) {
  const DirectionList list = list_of(random_directions(100, 8));
  double last = 0;
  for (const int size : {4, 16}) {
    ImportSettings settings = small_settings();
    settings.cube_size = size;
    settings.psnr_db = 40;
    const ImportSummary summary =
        import_bake(ball(list, 16, 8), list, settings, folder_ / "a.bake", {});
    double worst = 99;
    for (const ResamplingError& error : summary.resampling) worst = std::min(worst, error.psnr_db);
    EXPECT_GT(worst, last + 3) << size;
    last = worst;
  }
  EXPECT_GT(last, 40);
}

TEST_F(ImportBake, TheCubeMapSuitsTheNumberOfDirections) {
  EXPECT_EQ(cube_size_for(1), 8);
  EXPECT_EQ(cube_size_for(128), 8);
  EXPECT_EQ(cube_size_for(129), 16);
  EXPECT_EQ(cube_size_for(600), 32);
  EXPECT_EQ(cube_size_for(kMostDirections), 64);
}

TEST_F(ImportBake, TheBytesDoNotDependOnThreads) {
  const DirectionList list = list_of(random_directions(40, 9));
  const auto bake = [&](const char* name, int threads) {
    set_thread_count(threads);
    import_bake(ball(list, 70, 30), list, small_settings(), folder_ / name, {});
    set_thread_count(0);
    return contents(folder_ / name);
  };
  const auto one = bake("a.bake", 1);
  EXPECT_GE(one.size(), 4u);
  EXPECT_EQ(one, bake("a.bake", 3));
}

TEST_F(ImportBake, BlackTransportIsABlackBake) {
  const DirectionList list = list_of({{0, 0, -1}});  // from behind the ball
  import_bake(ball(list), list, small_settings(), folder_ / "a.bake", {});
  const RgbImage image = render(folder_ / "a.bake", uniform_environment(1));
  for (const Vec3f& pixel : image.pixels) EXPECT_EQ(pixel, Vec3f());
}

TEST_F(ImportBake, AFailedImportLeavesTheOldBakeAndNothingElse) {
  const DirectionList list = list_of(random_directions(20, 10));
  import_bake(ball(list), list, small_settings(), folder_ / "a.bake", {});
  const auto before = contents(folder_ / "a.bake");
  const DirectionList more = list_of(random_directions(21, 10));
  EXPECT_THAT(test::error_of(
                  [&] { import_bake(ball(list), more, small_settings(), folder_ / "a.bake", {}); }),
              HasSubstr("lights.txt: found 21 directions, expected 20"));
  const auto stop = [](const BakeProgress& progress) {
    if (progress.stage == "compressing") throw Error("disk", "none", "one");
  };
  EXPECT_EQ(test::error_of(
                [&] { import_bake(ball(list), list, small_settings(), folder_ / "a.bake", stop); }),
            "disk: found none, expected one");
  EXPECT_EQ(contents(folder_ / "a.bake"), before);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.bake.partial"));
}

}  // namespace
}  // namespace rimlight
